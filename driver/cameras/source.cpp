#include "driver/cameras/source.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "driver/cameras/live_camera.hpp"
#include "driver/cameras/match.hpp"

namespace palpa::driver::cameras {
namespace {

constexpr std::size_t most_cameras = 64;
constexpr double look_s = 0.02;    ///< how often to check whether a camera is silent or back
constexpr double pause_s = 0.002;  ///< after a camera has woken palpa for nothing
constexpr double coarse_m = 0.5e-3;
constexpr double unmatched_s = 1;  ///< after this time without a set, that is reported
constexpr double set_back_s = 1;   ///< frames that are older than this by more come from a clock that was set back

class Cameras final : public sensing::DepthSource {
 public:
  Cameras(std::unique_ptr<Host> host, std::vector<sensing::Camera> cameras,
          std::vector<std::unique_ptr<Device>> devices, const std::string& rig)
      : host_(std::move(host)), cameras_(std::move(cameras)), rig_(rig) {
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      sensing::Camera& camera = cameras_[c];
      live_.emplace_back(*host_, camera.name, std::move(devices[c]));
      if (const auto& lens = live_.back().lens()) {
        camera.fx = lens->fx;
        camera.fy = lens->fy;
        camera.cx = lens->cx;
        camera.cy = lens->cy;
        camera.distortion = lens->distortion;
        if (const std::string odd = sensing::implausible_lens(camera); !odd.empty())
          log::warning(fmt::format("camera '{}': its own calibration: {}", camera.name, odd));
      }
      camera.device = {};  // the settings have been applied; a recording of it is a file
      camera.rate_hz = 1 / live_.back().period_s();
      nominal_s_ = std::max(nominal_s_, live_.back().period_s());
      if (camera.depth_unit_m >= coarse_m) {
        log::warning(
            fmt::format("{}: camera '{}' has a depth unit of {:g} mm, which is coarse for a shell of 1.5 mm; set "
                        "depth_unit_m = 0.0001",
                        rig, camera.name, camera.depth_unit_m * 1e3));
      }
    }
  }

  const std::vector<sensing::Camera>& cameras() const override { return cameras_; }

  bool next(sensing::FrameSet& out, double timeout_s) override {
    const double end_s = host_->now_s() + timeout_s;
    for (;;) {
      bool any = false;
      for (LiveCamera& camera : live_)
        any = camera.tend() || any;
      if (deliver(out)) return true;
      const double left_s = end_s - host_->now_s();
      if (left_s <= 0) break;
      wait(left_s, any);
    }
    // The images' storage is kept for the next set.
    if (spare_.empty()) out.frames.swap(spare_);
    out.frames.clear();
    return true;
  }

 private:
  /// Waits until a camera has something, or has been silent for a while. `any`: the last look at the cameras found
  /// something.
  void wait(double left_s, bool any) {
    std::size_t count = 0;
    for (const LiveCamera& camera : live_) {
      if (camera.fd() >= 0) polled_[count++] = {camera.fd(), POLLIN, 0};
    }
    const bool woken = host_->poll(std::span(polled_).first(count), std::min(left_s, look_s)) > 0;
    // A device that has failed, or that returns its buffers empty, must not keep the processor busy.
    if (woken && !any && !woken_) {
      woken_ = true;
    } else if (woken && !any) {
      host_->poll({}, pause_s);
    } else {
      woken_ = false;
    }
  }

  bool deliver(sensing::FrameSet& out) {
    double period_s = nominal_s_;
    std::size_t count = 0;
    do {
      count = choose(period_s);
      if (count == 0) return false;
    } while (came_too_late(count));
    if (out.frames.empty()) out.frames.swap(spare_);
    out.frames.resize(cameras_.size());
    out.time_s = oldest_s(count);
    for (std::size_t c = 0, k = 0; c < cameras_.size(); ++c) {
      sensing::DepthFrame& frame = out.frames[c];
      frame.depth.resize(sensing::pixel_count(cameras_[c]));
      if (k < count && awaited_[k] == &live_[c]) {
        frame.time_s = waiting_[k].times_s[chosen_[k]];
        live_[c].copy(chosen_[k], frame.depth.data());
        live_[c].release_through(chosen_[k]);
        ++k;
      } else {
        frame.time_s = out.time_s;
        std::fill(frame.depth.begin(), frame.depth.end(), std::uint16_t{0});
      }
    }
    out.sequence = number(out.time_s, period_s);
    return true;
  }

  /// Chooses the frames of the next set among those of the cameras that are waited for. Returns how many these are; 0
  /// if there is no set yet. `period_s` grows to the period of the slowest of them.
  std::size_t choose(double& period_s) {
    std::size_t count = 0;
    bool all_give = true;
    for (LiveCamera& camera : live_) {
      if (!camera.awaited()) continue;
      awaited_[count] = &camera;
      waiting_[count++] = {camera.times_s()};
      period_s = std::max(period_s, camera.period_s());
      all_give = all_give && camera.gives_frames();
    }
    if (count > 0 && match(std::span(waiting_).first(count), period_s, chosen_)) {
      note_matched();
      return count;
    }
    count > 1 && all_give ? note_unmatched(period_s) : note_matched();
    return 0;
  }

  double oldest_s(std::size_t count) const {
    double time_s = waiting_[0].times_s[chosen_[0]];
    for (std::size_t k = 1; k < count; ++k)
      time_s = std::min(time_s, waiting_[k].times_s[chosen_[k]]);
    return time_s;
  }

  /// While one camera was silent, a newer set of the others may have been delivered. Its older frames are then left
  /// out, because a hand does not go back. A clock that was set back is something else.
  bool came_too_late(std::size_t count) {
    const double behind_s = last_s_ - oldest_s(count);
    if (behind_s < 0 || behind_s > set_back_s) return false;
    for (std::size_t k = 0; k < count; ++k)
      awaited_[k]->release_through(chosen_[k]);
    return true;
  }

  void note_matched() { unmatched_since_s_ = std::numeric_limits<double>::infinity(); }

  /// Frames come, but none that fit together. Frames of one rate always fit.
  void note_unmatched(double period_s) {
    const double now_s = host_->now_s();
    unmatched_since_s_ = std::min(unmatched_since_s_, now_s);
    if (unmatched_said_ || now_s - unmatched_since_s_ < unmatched_s) return;
    unmatched_said_ = true;
    log::warning(
        fmt::format("the cameras' frames do not fit together: for {:g} s, none were captured within {:.1f} ms of each "
                    "other; give all cameras the same rate_hz and a fixed exposure_s in {}",
                    unmatched_s, (period_s / 2 + stamp_jitter_s) * 1e3, rig_));
  }

  /// Counts the periods that have passed, so that missed frames are gaps.
  std::uint64_t number(double time_s, double period_s) {
    if (last_s_ > 0) sequence_ += static_cast<std::uint64_t>(std::max(1L, std::lround((time_s - last_s_) / period_s)));
    last_s_ = time_s;
    return sequence_;
  }

  std::unique_ptr<Host> host_;
  std::vector<sensing::Camera> cameras_;
  std::deque<LiveCamera> live_;  ///< a deque, because their addresses must stay
  std::string rig_;
  double nominal_s_ = 0;  ///< requested period of the slowest camera
  double unmatched_since_s_ = std::numeric_limits<double>::infinity();
  bool unmatched_said_ = false;
  std::array<pollfd, most_cameras> polled_{};
  std::array<LiveCamera*, most_cameras> awaited_{};
  std::array<Waiting, most_cameras> waiting_{};
  std::array<std::uint32_t, most_cameras> chosen_{};
  std::vector<sensing::DepthFrame> spare_;
  std::uint64_t sequence_ = 0;
  double last_s_ = 0;
  bool woken_ = false;  ///< the last wait ended for nothing
};

}  // namespace

std::vector<std::string> parse_names(const std::string& argument, const std::string& kind, const std::string& example) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= argument.size();) {
    const std::size_t end = std::min(argument.find(',', begin), argument.size());
    std::string name = argument.substr(begin, end - begin);
    if (name.empty()) throw bad_usage(fmt::format("source {0} needs cameras: {0}:{1}", kind, example));
    if (std::find(names.begin(), names.end(), name) != names.end())
      throw bad_usage(fmt::format("source {} names {} twice; name each camera of the rig once", kind, name));
    names.push_back(std::move(name));
    begin = end + 1;
  }
  return names;
}

void check_count(std::size_t named, std::size_t cameras, const std::string& kind, const std::string& rig) {
  if (named == cameras && named <= most_cameras) return;
  throw bad_usage(
      fmt::format("source {} names {}, but {} describes {}; name as many cameras as the rig has, in the same "
                  "order (palpa doctor --write-rig FILE writes a rig for the cameras that are plugged in)",
                  kind, counted(named, "camera"), rig, cameras));
}

std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<Host> host, std::vector<sensing::Camera> cameras,
                                                   std::vector<std::unique_ptr<Device>> devices,
                                                   const std::string& rig) {
  return std::make_unique<Cameras>(std::move(host), std::move(cameras), std::move(devices), rig);
}

}  // namespace palpa::driver::cameras
