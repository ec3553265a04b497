#include "touch/fingers/sector_borders.hpp"

#include <cmath>
#include <numbers>

#include "touch/types.hpp"

namespace palpa::touch {
namespace {

/// The direction of angle 2 pi n / N, exact if it lies on an axis.
Float2 border(std::uint32_t n, std::uint32_t foci) {
  const double angle = 2 * std::numbers::pi * n / foci;
  double x = std::cos(angle), y = std::sin(angle);
  if (std::abs(x) < 1e-12) x = 0;
  if (std::abs(y) < 1e-12) y = 0;
  return {static_cast<float>(x), static_cast<float>(y)};
}

}  // namespace

std::vector<Float2> sector_borders() {
  std::vector<Float2> borders;
  borders.reserve(first_border(max_foci + 1));
  for (std::uint32_t foci = 1; foci <= max_foci; ++foci) {
    for (std::uint32_t n = 0; n < foci; ++n)
      borders.push_back(border(n, foci));
  }
  return borders;
}

}  // namespace palpa::touch
