// A session live from skin points: another program knows where the skin is, and pushes frames of points from any
// thread. Session::run does the same for depth frames.
#pragma once

#include <atomic>
#include <condition_variable>
#include <glm/vec3.hpp>
#include <mutex>
#include <vector>

#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/run_options.hpp"
#include "session/session.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

/// Frames of points on their way to a session. The newest one wins.
class PushedPoints {
 public:
  /// take() waits by `clock`, which must outlive the object.
  explicit PushedPoints(const Clock& clock = real_clock()) : clock_(clock) {}

  /// Metres, world; the time of their capture in seconds, on any clock. Never waits for the session. True: this
  /// replaced a frame that the session has not taken.
  bool push(std::vector<glm::vec3> points, double time_s);
  /// Waits up to `timeout_s` for a new frame, and takes it. False: none came.
  bool take(std::vector<glm::vec3>& points, double& time_s, double timeout_s);

 private:
  const Clock& clock_;
  std::mutex mutex_;
  std::condition_variable came_;
  bool fresh_ = false;
  std::vector<glm::vec3> points_;
  double time_s_ = 0;
};

/// Computes on the calling thread, and plays on another (loop/output.hpp), so that drives leave on time. A frame is
/// captured when it is taken, and sounds at most for the setting's hold. Runs until `options.frames` are done, `stop`
/// becomes true or something fails; the last drive that `link` gets is all-zero, whatever happens. An Error of either
/// thread is thrown here, after silence. Fingers that still touch are released at the end, and if no frame comes for
/// the hold. The observer gets `planned`, `expired`, `sent` and `events`, and nothing else, and the
/// changes only `before_frame`. All times are those of `clock`. Throws bad_usage for a session with cameras, without an
/// array, or with Tune::all.
LoopStats run_points(Session& session, PushedPoints& source, Link& link, std::atomic<bool>& stop,
                     const RunOptions& options = {}, const Clock& clock = Clock());

}  // namespace palpa::session
