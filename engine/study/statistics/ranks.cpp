#include "study/statistics/ranks.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpa::study {

double Ranks::tie_sum() const {
  double sum = 0;
  for (const std::uint64_t group : tied) {
    const auto t = static_cast<double>(group);
    sum += t * t * t - t;
  }
  return sum;
}

Ranks midranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  Ranks ranks{.of = std::vector<double>(values.size()), .tied = {}};
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && values[order[end]] == values[order[begin]])
      ++end;
    for (std::size_t i = begin; i < end; ++i)
      ranks.of[order[i]] = static_cast<double>(begin + 1 + end) / 2;
    if (end - begin > 1) ranks.tied.push_back(end - begin);
    begin = end;
  }
  return ranks;
}

}  // namespace palpa::study
