// The frames that wait for a recorder, which may be slower than the cameras for a while.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <vector>

#include "sensing/depth_source.hpp"
#include "session/clock.hpp"

namespace palpa::session {

/// Between one thread that adds frames and one that takes them. Memory of frames that were taken is used again.
class FrameQueue {
 public:
  /// Images of at most this many bytes wait, but always one frame. With 0, only the newest frame waits.
  /// All waits are by `clock`, which must outlive the object.
  explicit FrameQueue(std::uint64_t most_bytes, const Clock& clock = real_clock())
      : most_bytes_(most_bytes), clock_(clock) {}

  /// Adds a copy of the frame. If there is no room for it, it replaces the frame that was added last; the result is
  /// then true.
  bool add(const sensing::FrameSet& set);
  /// No more frames will be added.
  void close();

  /// Moves the oldest frame into `out`. Waits for one, at most this long. False if there is none.
  bool take(sensing::FrameSet& out, std::chrono::duration<double> timeout);
  /// Waits until no frame waits, at most this long. False if one still does.
  bool wait_empty(std::chrono::duration<double> timeout);
  bool closed();
  /// Whether it is closed and no frame waits.
  bool over();
  std::size_t waiting();
  /// Discards the frames that wait, and returns their number.
  std::size_t discard();

 private:
  std::uint64_t most_bytes_;
  const Clock& clock_;
  std::mutex mutex_;
  std::condition_variable arrived_, emptied_;
  std::deque<sensing::FrameSet> frames_;
  std::vector<sensing::FrameSet> spare_;  ///< frames without meaning, whose memory is used again
  std::uint64_t bytes_ = 0;               ///< of the images that wait
  bool closed_ = false;
};

}  // namespace palpa::session
