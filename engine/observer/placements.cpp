#include "observer/placements.hpp"

#include <algorithm>
#include <cmath>

#include "base/normal.hpp"

namespace palpa::observer {

std::vector<FingerPlace> places_of(const PlacePrior& prior, std::uint32_t count) {
  // The real root of x^4 = x + 1: its powers fill a cube evenly (Roberts 2018).
  constexpr double root = 1.2207440846057596;
  const auto quantile = [](std::uint32_t i, double step) {
    const double at = 0.5 + step * (i + 1);
    return normal_quantile(std::min(std::max(at - std::floor(at), 1e-6), 1 - 1e-6));
  };
  std::vector<FingerPlace> places;
  for (std::uint32_t i = 0; i < count; ++i) {
    places.push_back({prior.lateral_m * quantile(i, 1 / root), prior.lateral_m * quantile(i, 1 / (root * root)),
                      prior.yaw_rad * quantile(i, 1 / (root * root * root))});
  }
  return places;
}

}  // namespace palpa::observer
