// Frames of skin points that another program pushes, as the source of a run.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "sensing/depth_source.hpp"
#include "session/clock.hpp"

namespace palpa::session {

/// The newest frame wins. Copies share their frames: one is pushed to, from any thread, and another one is read by the
/// run. The session's setting must be `pushed`.
class PushedPoints final : public sensing::DepthSource {
 public:
  /// next() waits by `clock`, which must outlive all copies.
  explicit PushedPoints(const Clock& clock = real_clock()) : clock_(&clock) {}

  /// Metres, world, indices ascend; the time of their capture in seconds, on any clock. Never waits for the session.
  /// True: this replaced a frame that the session has not taken.
  bool push(std::vector<sensing::SkinPoint> points, double time_s);

  const std::vector<sensing::Camera>& cameras() const override { return no_cameras_; }
  /// Never ends.
  bool next(sensing::FrameSet& out, double timeout_s) override;

 private:
  struct Newest {
    std::mutex mutex;
    std::condition_variable came;
    sensing::FrameSet frame;
    bool fresh = false;
  };

  const Clock* clock_;
  std::vector<sensing::Camera> no_cameras_;
  std::shared_ptr<Newest> newest_ = std::make_shared<Newest>();
};

}  // namespace palpa::session
