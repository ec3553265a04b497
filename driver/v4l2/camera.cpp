#include "driver/v4l2/camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::driver::v4l2 {
namespace {

constexpr double first_frame_s = 3;    ///< a camera takes up to two seconds from its start to its first frame
constexpr double silent_s = 0.05;      ///< who has given no frame for that long, or four periods, is not waited for,
constexpr double said_silent_s = 1;    ///< after that long it is said,
constexpr double restarted_s = 3;      ///< and after that long the stream is started anew
constexpr double look_every_s = 0.25;  ///< for a camera that is gone,
constexpr double longest_rest_s = 60;  ///< and at least that often for one that takes long to fail
constexpr std::uint32_t said_broken = 5;

}  // namespace

LiveCamera::LiveCamera(Kernel& kernel, Description description)
    : kernel_(kernel), description_(std::move(description)), path_(description_.path) {
  identity_.path = description_.path;
  const std::string real = kernel_.resolve(path_);
  for (const Node& node : kernel_.nodes()) {
    if (node.path == real) identity_.node = node;
  }
  open();
  await_until_s_ = opened_s_ + first_frame_s;
}

void LiveCamera::open() {
  stream_ = std::make_unique<Stream>(kernel_, path_, description_.wanted, description_.rig,
                                     [this](int fd) { configure(fd); });
  period_s_ = stream_->period_s();
  opened_s_ = kernel_.now_s();
  frame_s_ = 0;
}

void LiveCamera::configure(int fd) {
  const sensing::DeviceSetting& setting = description_.setting;
  if (!d400::is_realsense(identity_.node)) {
    if (setting.own_lens || setting.exposure_s || setting.preset) {
      throw bad_input(path_, fmt::format("is no RealSense on USB, which calibration = \"device\", exposure_s and "
                                         "hardware_preset of {} are for",
                                         description_.rig));
    }
    return;
  }
  try {
    if (setting.preset) d400::write_hardware_preset(kernel_, fd, *setting.preset);
    if (setting.exposure_s) d400::write_exposure(kernel_, fd, *setting.exposure_s);
    const Wanted& wanted = description_.wanted;
    if (setting.own_lens) lens_ = d400::read_lens(kernel_, fd, wanted.width, wanted.height);
  } catch (const Error& error) {
    throw bad_input(path_, error.what());
  }
  set_depth_unit(fd);
}

void LiveCamera::set_depth_unit(int fd) {
  const double wanted_m = description_.depth_unit_m;
  const auto is = [](double a, double b) { return std::abs(a - b) < 0.5e-6; };
  double unit_m = 0;
  try {
    unit_m = d400::read_depth_unit(kernel_, fd);
    if (!is(unit_m, wanted_m)) {
      d400::write_depth_unit(kernel_, fd, wanted_m);
      unit_m = d400::read_depth_unit(kernel_, fd);
    }
  } catch (const Error& error) {
    if (unit_m == 0 && !unit_read_) {
      if (!std::exchange(trusted_said_, true))
        log::warning(fmt::format("{}: {}; that a step is {:g} mm, as {} says, is taken on trust", path_, error.what(),
                                 wanted_m * 1e3, description_.rig));
      return;
    }
    throw bad_input(path_, error.what());
  }
  unit_read_ = true;
  // Ten times too deep is a hand elsewhere.
  if (!is(unit_m, wanted_m)) {
    throw bad_input(path_, fmt::format("keeps its depth unit of {:g} mm; set depth_unit_m = {:g} in {}", unit_m * 1e3,
                                       unit_m, description_.rig));
  }
}

void LiveCamera::reopen() {
  const double now_s = kernel_.now_s();
  if (now_s < retry_s_) return;
  // The kernel may wait five seconds for a device that does not answer: meanwhile nobody looks at the others.
  const auto rest = [&] {
    const double took_s = kernel_.now_s() - now_s;
    retry_s_ = kernel_.now_s() + std::clamp(10 * took_s, look_every_s, longest_rest_s);
  };
  retry_s_ = now_s + look_every_s;
  const std::string path = find_again(identity_, kernel_.nodes());
  if (path.empty()) return;
  path_ = path;
  try {
    open();
  } catch (const Error& error) {
    rest();
    // A device that comes back is not whole at once; and one that has come back slower is refused for good.
    if (now_s - lost_s_ < 2 || refusal_said_) return;
    refusal_said_ = true;
    log::warning(fmt::format("camera '{}' cannot be opened again: {}", description_.name, error.what()));
  }
}

bool LiveCamera::tend() {
  if (!stream_) reopen();
  if (!stream_) return false;
  bool any = false;
  // As many as it can have at once: one that never ends may not keep the others.
  for (std::uint32_t i = 0; i < Stream::most_buffers; ++i) {
    Taken taken;
    const Take found = stream_->take(taken);
    if (found == Take::nothing) break;
    if (found == Take::gone) {
      const std::string how = stream_->fault();
      drop();
      say_lost(how);
      return any;
    }
    if (found == Take::broken) {
      count_broken();
      continue;
    }
    keep(taken);
    any = true;
  }
  const double now_s = kernel_.now_s();
  if (any) {
    frame_s_ = now_s;
    say_back();
  }
  const double since_s = now_s - std::max(frame_s_, opened_s_);
  if (since_s > said_silent_s && now_s > await_until_s_) say_lost("gives no frames");
  if (since_s > restarted_s) drop();
  return any;
}

bool LiveCamera::awaited() const {
  if (!stream_) return false;
  const double now_s = kernel_.now_s();
  return frame_s_ > 0 ? now_s - frame_s_ < std::max(silent_s, 4 * period_s_) : now_s < await_until_s_;
}

void LiveCamera::keep(const Taken& taken) {
  if (held_ == most_held) release_through(0);
  taken_[held_] = taken;
  times_s_[held_] = taken.time_s;
  ++held_;
}

void LiveCamera::release_through(std::uint32_t frame) {
  const std::uint32_t released = frame + 1;
  for (std::uint32_t i = 0; i < released; ++i)
    stream_->release(taken_[i]);
  std::copy(taken_.begin() + released, taken_.begin() + held_, taken_.begin());
  std::copy(times_s_.begin() + released, times_s_.begin() + held_, times_s_.begin());
  held_ -= released;
}

void LiveCamera::drop() {
  held_ = 0;
  stream_.reset();
  retry_s_ = kernel_.now_s() + look_every_s;
}

void LiveCamera::count_broken() {
  if (++broken_ != said_broken) return;
  log::warning(
      fmt::format("camera '{}' ({}): {} frames came short, damaged or twice and were left out; a cable of 2 m at most "
                  "and a port of "
                  "its own help",
                  description_.name, path_, broken_));
}

void LiveCamera::say_lost(const std::string& how) {
  if (lost_) return;
  lost_ = true;
  lost_s_ = kernel_.now_s();
  refusal_said_ = false;
  log::warning(
      fmt::format("camera '{}' ({}): {}; palpa goes on without it and looks for it", description_.name, path_, how));
}

void LiveCamera::say_back() {
  if (!lost_) return;
  lost_ = false;
  log::warning(fmt::format("camera '{}' ({}): is back", description_.name, path_));
}

}  // namespace palpa::driver::v4l2
