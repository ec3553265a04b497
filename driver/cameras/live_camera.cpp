#include "driver/cameras/live_camera.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"

namespace palpa::driver::cameras {
namespace {

constexpr double first_frame_s = 3;    ///< a camera takes up to two seconds from its start to its first frame
constexpr double silent_s = 0.05;      ///< without a frame for this long, or four periods, a camera is not waited for
constexpr double said_silent_s = 1;    ///< after this time, that is reported
constexpr double restarted_s = 3;      ///< after this time, the stream is restarted
constexpr double look_every_s = 0.25;  ///< how often a lost camera is looked for
constexpr std::uint32_t said_broken = 5;

}  // namespace

LiveCamera::LiveCamera(Host& host, std::string name, std::unique_ptr<Device> device)
    : host_(host), name_(std::move(name)), device_(std::move(device)), stream_(device_->open()) {
  opened_s_ = host_.now_s();
  await_until_s_ = opened_s_ + first_frame_s;
}

LiveCamera::~LiveCamera() {
  if (beside_.valid()) beside_.wait();
}

/// The kernel may wait five seconds for a device that does not answer. The other cameras' frames do not wait for that.
void LiveCamera::look_for_it() {
  if (!beside_.valid()) {
    if (host_.now_s() < retry_s_) return;
    try {
      beside_ = host_.beside([this] { find_and_open(); });
    } catch (const std::system_error&) {  // no thread now, so try later
      retry_s_ = host_.now_s() + look_every_s;
      return;
    }
  }
  if (beside_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  beside_.get();
  adopt();
}

void LiveCamera::find_and_open() {
  old_.reset();
  refusal_.clear();
  try {
    new_ = device_->open_again();
  } catch (const Error& error) {
    refusal_ = error.what();
  }
}

/// Takes the result of the background work.
void LiveCamera::adopt() {
  const double now_s = host_.now_s();
  retry_s_ = now_s + look_every_s;
  if (new_) {
    stream_ = std::move(new_);
    opened_s_ = now_s;
    frame_s_ = last_s_ = 0;
    distances_s_ = {};
    return;
  }
  // A device that comes back is not complete at once. One that has come back slower is refused for good.
  if (refusal_.empty() || now_s - lost_s_ < 2 || refusal_said_) return;
  refusal_said_ = true;
  log::warning(fmt::format("camera '{}' cannot be opened again: {}", name_, refusal_));
}

bool LiveCamera::tend() {
  if (!stream_) look_for_it();
  if (!stream_) return false;
  bool any = false;
  // Takes at most as many frames as the camera can have at once, so that an endless camera does not hold up the others.
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
  const double now_s = host_.now_s();
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
  const double now_s = host_.now_s();
  if (frame_s_ == 0) return now_s < await_until_s_;
  return now_s - frame_s_ < std::max({silent_s, 4 * stream_->period_s(), 1.5 * period_s()});
}

double LiveCamera::period_s() const {
  const double least_s = *std::min_element(distances_s_.begin(), distances_s_.end());
  return std::max(stream_->period_s(), least_s);
}

void LiveCamera::keep(const Taken& taken) {
  if (last_s_ > 0) distances_s_[next_distance_++ % distances] = taken.time_s - last_s_;
  last_s_ = taken.time_s;
  // The camera keeps two: the one that it fills, and the next.
  if (held_ == std::min(most_held, stream_->buffers() - 2)) release_through(0);
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
  old_ = std::move(stream_);
  try {
    beside_ = host_.beside([this] { old_.reset(); });
  } catch (const std::system_error&) {  // no thread now: find_and_open() does it later
  }
  refusal_.clear();
}

void LiveCamera::count_broken() {
  if (++broken_ != said_broken) return;
  log::warning(
      fmt::format("camera '{}' ({}): {} frames arrived incomplete, damaged or twice and were dropped; use a cable of "
                  "at most 2 m and a separate USB port",
                  name_, device_->address(), broken_));
}

void LiveCamera::say_lost(const std::string& how) {
  if (lost_) return;
  lost_ = true;
  lost_s_ = host_.now_s();
  refusal_said_ = false;
  log::warning(fmt::format("camera '{}' ({}): {}; palpa continues without it and keeps looking for it", name_,
                           device_->address(), how));
}

void LiveCamera::say_back() {
  if (!lost_) return;
  lost_ = false;
  log::warning(fmt::format("camera '{}' ({}): is back", name_, device_->address()));
}

}  // namespace palpa::driver::cameras
