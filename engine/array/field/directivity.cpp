#include "array/field/directivity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace palpa::array {
namespace {

constexpr std::size_t knots = 10;
constexpr double knot_step = std::numbers::pi / 18;
constexpr std::array<double, knots> t4010a1_at{1, 1, 1, 0.8913, 0.7079, 0.5012, 0.3548, 0.2512, 0.1995, 0.1778};

/// Slopes per step, for which no cubic leaves its interval (Fritsch and Carlson 1980): harmonic means, the variant of
/// Fritsch and Butland (1984).
constexpr std::array<double, knots> monotone_slopes(const std::array<double, knots>& values) {
  std::array<double, knots> slopes{};
  for (std::size_t i = 1; i + 1 < knots; ++i) {
    const double before = values[i] - values[i - 1];
    const double after = values[i + 1] - values[i];
    slopes[i] = before * after > 0 ? 2 * before * after / (before + after) : 0;
  }
  // The curve is even about the axis. At 90 degrees it keeps the slope of the last interval.
  slopes[knots - 1] = values[knots - 1] - values[knots - 2];
  return slopes;
}
constexpr std::array<double, knots> t4010a1_slopes = monotone_slopes(t4010a1_at);

double t4010a1(double angle) {
  const double steps = std::clamp(angle / knot_step, 0.0, static_cast<double>(knots - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(steps), knots - 2);
  const double t = steps - static_cast<double>(i);
  const double u = 1 - t;
  return u * u * ((1 + 2 * t) * t4010a1_at[i] + t * t4010a1_slopes[i]) +
         t * t * ((1 + 2 * u) * t4010a1_at[i + 1] - u * t4010a1_slopes[i + 1]);
}

double piston(double sine, double ka) {
  const double x = ka * sine;
  // 1 - x^2 / 8 + ...
  return x < 1e-4 ? 1.0 : 2 * std::cyl_bessel_j(1.0, x) / x;
}

}  // namespace

double directivity(Directivity kind, double cosine, double ka) {
  if (kind == Directivity::omni) return 1;
  const double c = std::clamp(cosine, -1.0, 1.0);
  const double front = std::max(c, 0.0);
  const double behind = 1 + std::min(c, 0.0);
  const double value =
      kind == Directivity::piston ? piston(std::sqrt(1 - front * front), ka) : t4010a1(std::acos(front));
  return value * behind * behind;
}

std::vector<double> directivity_table(Directivity kind, double ka) {
  std::vector<double> table(directivity_steps + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    table[i] = directivity(kind, -1 + 2 * static_cast<double>(i) / static_cast<double>(directivity_steps), ka);
  }
  return table;
}

}  // namespace palpa::array
