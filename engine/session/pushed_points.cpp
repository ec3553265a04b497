#include "session/pushed_points.hpp"

#include <utility>

namespace palpa::session {

bool PushedPoints::push(std::vector<sensing::SkinPoint> points, double time_s) {
  bool replaced = false;
  {
    const std::lock_guard lock(newest_->mutex);
    sensing::FrameSet& frame = newest_->frame;
    frame.points = std::move(points);
    frame.pushed = true;
    frame.time_s = time_s;
    ++frame.sequence;
    replaced = std::exchange(newest_->fresh, true);
  }
  clock_->wake(newest_->came);
  return replaced;
}

bool PushedPoints::next(sensing::FrameSet& out, double timeout_s) {
  std::unique_lock lock(newest_->mutex);
  if (clock_->wait(newest_->came, lock, timeout_s, [this] { return newest_->fresh; })) {
    std::swap(out.points, newest_->frame.points);
    out.pushed = true;
    out.time_s = newest_->frame.time_s;
    out.sequence = newest_->frame.sequence - 1;  // it counts from 0
    newest_->fresh = false;
  } else {
    out.pushed = false;
  }
  return true;
}

}  // namespace palpa::session
