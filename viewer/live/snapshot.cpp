#include "viewer/live/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpa::viewer {

void TimeBins::add(double seconds) {
  const double bin = std::clamp(std::floor(seconds / budget_s * 10), 0.0, static_cast<double>(counts.size() - 1));
  ++counts[static_cast<std::size_t>(bin)];
}

std::uint32_t TimeBins::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint32_t{0});
}

double TimeBins::quantile(double p) const {
  const double wanted = p * total();
  double seen = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    seen += counts[i];
    if (seen >= wanted && seen > 0) return static_cast<double>(i + 1) / 10 * budget_s;
  }
  return 0;
}

}  // namespace palpa::viewer
