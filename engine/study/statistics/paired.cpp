#include "study/statistics/paired.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.hpp"
#include "study/statistics/wilcoxon.hpp"

namespace palpa::study {

HodgesLehmann hodges_lehmann(std::span<const double> differences) {
  std::vector<double> walsh;
  walsh.reserve(differences.size() * (differences.size() + 1) / 2);
  for (std::size_t i = 0; i < differences.size(); ++i) {
    for (std::size_t j = i; j < differences.size(); ++j)
      walsh.push_back((differences[i] + differences[j]) / 2);
  }
  std::ranges::sort(walsh);
  const std::size_t half = walsh.size() / 2;
  HodgesLehmann found{.estimate = walsh.size() % 2 == 1 ? walsh[half] : (walsh[half - 1] + walsh[half]) / 2};
  const std::size_t k = signed_rank_index(differences.size(), 0.025);
  if (k > 0) found.interval = Interval{walsh[k - 1], walsh[walsh.size() - k]};
  return found;
}

std::uint32_t bootstrap_resamples(std::size_t values) {
  constexpr std::size_t most = 100'000, most_draws = 20'000'000;
  return static_cast<std::uint32_t>(std::clamp(most_draws / std::max<std::size_t>(values, 1), std::size_t{2000}, most));
}

std::optional<Interval> bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::uint32_t resamples) {
  if (values.size() < 2) return std::nullopt;
  Random random(seed);
  std::vector<double> means(resamples);
  for (double& one : means) {
    double sum = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      sum += values[random.below(values.size())];
    one = sum / static_cast<double>(values.size());
  }
  std::ranges::sort(means);
  const auto count = static_cast<double>(resamples);
  const auto low = static_cast<std::size_t>(std::floor(0.025 * (count - 1)));
  const auto high = static_cast<std::size_t>(std::ceil(0.975 * (count - 1)));
  return Interval{means[low], means[high]};
}

}  // namespace palpa::study
