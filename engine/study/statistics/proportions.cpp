#include "study/statistics/proportions.hpp"

#include <cmath>

#include "base/normal.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {

Interval clopper_pearson(std::uint64_t k, std::uint64_t n) {
  const auto hits = static_cast<double>(k), misses = static_cast<double>(n - k);
  return {k == 0 ? 0 : beta_quantile(hits, misses + 1, 0.025), k == n ? 1 : beta_quantile(hits + 1, misses, 0.975)};
}

Interval wilson(std::uint64_t k, std::uint64_t n) {
  const auto count = static_cast<double>(n);
  const double p = static_cast<double>(k) / count, z = normal_quantile(0.975), zz = z * z;
  const double half = z * std::sqrt(p * (1 - p) / count + zz / (4 * count * count));
  const double scale = 1 + zz / count, middle = p + zz / (2 * count);
  // Rounding must not leave 0 or 1 where k is 0 or n.
  return {k == 0 ? 0 : (middle - half) / scale, k == n ? 1 : (middle + half) / scale};
}

}  // namespace palpa::study
