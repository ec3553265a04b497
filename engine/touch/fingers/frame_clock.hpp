// The time from frame to frame, in the form that following needs.
#pragma once

#include <cstdint>
#include <optional>

namespace palpa::touch {

/// A time of `us` that has gone on for `elapsed_us`. It ends at the longest time, 71 minutes.
inline std::uint32_t us_after(std::uint32_t us, std::uint32_t elapsed_us) {
  return us > 0xffffffffU - elapsed_us ? 0xffffffffU : us + elapsed_us;
}

class FrameClock {
 public:
  /// Microseconds from the capture time of the previous call's frame to `time_s`; follow_restart for the first
  /// call. If the time goes backwards, following restarts: the result is then longer than any finger is remembered.
  std::uint32_t elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

}  // namespace palpa::touch
