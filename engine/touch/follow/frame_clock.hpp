// The time from frame to frame, as following wants it.
#pragma once

#include <cstdint>
#include <optional>

namespace palpa::touch {

class FrameClock {
 public:
  /// Microseconds from the frame of the call before to this one's capture time; shader::follow_anew for the first. A
  /// time before the one before is a new beginning: longer than any finger is remembered.
  std::uint32_t elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

}  // namespace palpa::touch
