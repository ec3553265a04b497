#include "study/statistics/proportions.hpp"

#include "study/statistics/special.hpp"

namespace palpa::study {

Interval clopper_pearson(std::uint64_t k, std::uint64_t n) {
  const auto hits = static_cast<double>(k), misses = static_cast<double>(n - k);
  return {k == 0 ? 0 : beta_quantile(hits, misses + 1, 0.025), k == n ? 1 : beta_quantile(hits + 1, misses, 0.975)};
}

}  // namespace palpa::study
