#include "touch/fingers/frame_clock.hpp"

#include <cmath>

#include "touch/fingers/follow_math.hpp"

namespace palpa::touch {

std::uint32_t FrameClock::elapsed_us(double time_s) {
  const double elapsed = last_s_ ? (time_s - *last_s_) * 1e6 : 0;
  const bool first = !last_s_;
  last_s_ = time_s;
  if (first) return follow_restart;
  constexpr double forever = 4e9;
  return static_cast<std::uint32_t>(elapsed >= 0 && elapsed < forever ? std::llround(elapsed) : std::llround(forever));
}

}  // namespace palpa::touch
