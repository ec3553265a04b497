// The time from frame to frame, in the form that following needs.
#pragma once

#include <cstdint>
#include <optional>

namespace palpa::touch {

class FrameClock {
 public:
  /// Microseconds from the capture time of the previous call's frame to `time_s`; follow_restart for the first
  /// call. If the time goes backwards, following restarts: the result is then longer than any finger is remembered.
  std::uint32_t elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

}  // namespace palpa::touch
