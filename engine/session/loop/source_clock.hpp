// Maps a source's clock to the loop's, so that a frame's age is known.
#pragma once

#include <algorithm>
#include <limits>

namespace palpa::session {

/// The least delay between capture and arrival seen so far is taken for none: a frame that dawdled on its way is then
/// as old as it really is, but for what every frame takes alike: exposure and transfer, some 10 ms of a depth camera.
/// Nothing tells that part from two clocks that began at different times; whoever sets a hold has to allow for it.
/// The estimate leaks upwards, since clocks drift apart by some ten parts in a million, and starts anew when the
/// source's clock steps back, as it does when a camera is reset. No frame is younger than its arrival.
class SourceClock {
 public:
  /// Seconds on the loop's clock of a frame captured at `source_s` that arrived at `arrived_s`.
  double capture_time(double source_s, double arrived_s) {
    const double delay = arrived_s - source_s;
    if (source_s < last_source_s_) least_delay_ = delay;
    least_delay_ = std::min(delay, least_delay_ + leak * (arrived_s - last_arrived_s_));
    last_source_s_ = source_s;
    last_arrived_s_ = arrived_s;
    return source_s + least_delay_;
  }

 private:
  static constexpr double leak = 1e-3;  ///< seconds per second, more than any two clocks differ
  double least_delay_ = std::numeric_limits<double>::infinity();
  double last_source_s_ = -std::numeric_limits<double>::infinity();
  double last_arrived_s_ = 0;
};

}  // namespace palpa::session
