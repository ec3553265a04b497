#include "punch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "observer/afferents/half_space.hpp"

namespace palpa::observer {
namespace {

/// The vertical stress at depth z and distance r from the axis of a flat punch of radius a with a force of 1 N (Sneddon
/// 1946).
double stress_of_punch(double a, double z, double r) {
  const double xi = z / a, rho = r / a, middle = rho * rho + xi * xi - 1;
  const double root = std::sqrt(middle * middle + 4 * xi * xi);
  const double phi = std::atan2(2 * xi, middle), theta = std::atan(1 / xi);
  return (std::sin(phi / 2) / std::sqrt(root) +
          xi * std::sqrt(1 + xi * xi) * std::sin(1.5 * phi - theta) / (root * std::sqrt(root))) /
         (2 * std::numbers::pi * a * a);
}

/// The surface's deflection at distance r from such a punch, relative to that under it.
double reach_of_punch(double a, double r) {
  return r <= a ? 1 : 2 / std::numbers::pi * std::asin(a / r);
}

/// The force of a punch that is pressed in by 1 mm, N.
double force_of_punch(double a) {
  return 2 * a * skin_stiffness;
}

}  // namespace

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
