// Maps a source's clock to the loop's, so that a frame's age is known.
#pragma once

#include <algorithm>
#include <limits>

namespace palpa::session {

/// The least delay between capture and arrival so far is taken as zero delay. A delayed frame then has its true age,
/// except for the part that all frames have in common: exposure and transfer, about 10 ms for a depth camera. This part
/// cannot be distinguished from two clocks that began at different times, so the hold must allow for it. The estimate
/// leaks upwards, because clocks drift apart by about ten parts in a million. It restarts when the source's clock steps
/// back, for example after a camera reset. No frame has a capture time after its arrival.
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
  static constexpr double leak = 1e-3;  ///< seconds per second; more than the drift between any two clocks
  double least_delay_ = std::numeric_limits<double>::infinity();
  double last_source_s_ = -std::numeric_limits<double>::infinity();
  double last_arrived_s_ = 0;
};

}  // namespace palpa::session
