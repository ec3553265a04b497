#include "observer/afferents/punch.hpp"

#include <algorithm>
#include <cmath>

#include "observer/afferents/half_space.hpp"

namespace palpa::observer {

SkinMotion under_punch(std::span<const double> indentation_mm, double radius_mm, double distance_mm) {
  const std::size_t samples = indentation_mm.size();
  SkinMotion motion{SiteSignal(1, samples), SiteSignal(1, samples)};
  if (samples < 3) return motion;
  const double stress =
      force_of_punch(radius_mm) * stress_of_punch(radius_mm, depth_mm(AfferentClass::sa1), distance_mm);
  const double reach = reach_of_punch(radius_mm, distance_mm);
  const double wave_s = std::max(0.0, distance_mm - radius_mm) / wave_speed_mm_s;
  const auto delay = static_cast<std::size_t>(std::lround(wave_s * afferent_rate_hz));
  for (std::size_t n = 0; n < samples; ++n) {
    motion.stress.at(0, n) = stress * indentation_mm[n];
    if (n < delay) continue;
    const std::size_t middle = std::clamp<std::size_t>(n - delay, 1, samples - 2);
    motion.velocity.at(0, n) = reach * (indentation_mm[middle + 1] - indentation_mm[middle - 1]) / 2 * afferent_rate_hz;
  }
  return motion;
}

}  // namespace palpa::observer
