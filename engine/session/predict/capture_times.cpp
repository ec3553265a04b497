#include "session/predict/capture_times.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <utility>

#include "base/log.hpp"
#include "session/predict/prediction.hpp"

namespace palpa::session {

void CaptureTimes::report(bool& reported, double from_s, double to_s, const char* what) {
  if (std::exchange(reported, true)) return;
  log::warning(fmt::format("the source's capture times {} (from {:.3f} s to {:.3f} s): they have to ascend evenly",
                           what, from_s, to_s));
}

bool CaptureTimes::is_time(double time_s) {
  if (std::isfinite(time_s)) return true;
  if (!std::exchange(missing_, true))
    log::warning(
        fmt::format("a frame's capture time is {}, not a number of seconds: such frames are left out", time_s));
  return false;
}

void CaptureTimes::see(double time_s) {
  see(time_s, std::numeric_limits<double>::quiet_NaN(), 0);
}

void CaptureTimes::see(double time_s, double arrived_s, double age_s) {
  const double before_s = std::exchange(time_s_, time_s), before_arrived_s = std::exchange(arrived_s_, arrived_s);
  if (!std::exchange(known_, true)) return;
  const double passed_s = arrived_s - before_arrived_s;
  // Without an arrival, comparisons with NaN are false.
  const bool jumps = passed_s >= 0 ? time_s - before_s > passed_s + longest_jump_s : time_s - before_s > longest_gap_s;
  equal_ = time_s == before_s ? equal_ + 1 : 1;
  if (time_s < before_s) report(back_, before_s, time_s, "run backwards");
  if (jumps) report(jumped_, before_s, time_s, "jump");
  if (equal_ >= most_equal) report(still_, before_s, time_s, "stand still");
  if (looked_at_++ % late_among == 0) late_count_ = 0;
  late_count_ += age_s > most_ahead_s ? 1 : 0;
  if (late_count_ > most_late && !std::exchange(late_, true)) {
    log::warning(fmt::format(
        "frames arrive {:.0f} ms after their capture, late or in bursts: fingers are predicted for {:.0f} ms at most",
        age_s * 1e3, most_ahead_s * 1e3));
  }
}

}  // namespace palpa::session
