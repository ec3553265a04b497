#include "study/statistics/wilcoxon.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/normal.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {
namespace {

/// The probability of each sum of a random subset of `ranks`, which are whole numbers.
std::vector<double> sum_distribution(std::span<const std::size_t> ranks) {
  std::vector<double> probability{1};
  for (const std::size_t rank : ranks) {
    const std::size_t before = probability.size();
    std::vector<double> next(before + rank, 0);
    for (std::size_t s = 0; s < before; ++s) {
      // Halves instead of counts: 2^m would overflow, and a half of a double is exact.
      next[s] += probability[s] / 2;
      next[s + rank] += probability[s] / 2;
    }
    probability = std::move(next);
  }
  return probability;
}

/// p of a value this far from the mean, with a continuity correction.
double approximated(double distance, double deviation, double correction) {
  if (deviation <= 0) return 1;
  return normal_two_sided(std::max(0.0, std::abs(distance) - correction) / deviation);
}

}  // namespace

SignedRank wilcoxon(std::span<const double> differences, Zeros zeros) {
  std::vector<double> sizes, signs;
  for (const double d : differences) {
    if (d == 0 && zeros == Zeros::drop) continue;
    sizes.push_back(std::abs(d));
    signs.push_back(d);
  }
  SignedRank result{.pairs = differences.size()};
  const Ranks ranks = midranks(sizes);
  std::vector<std::size_t> doubled;  // midranks are multiples of a half
  for (std::size_t i = 0; i < signs.size(); ++i) {
    if (signs[i] == 0) continue;
    (signs[i] > 0 ? result.positive : result.negative) += ranks.of[i];
    doubled.push_back(static_cast<std::size_t>(std::lround(2 * ranks.of[i])));
  }
  result.nonzero = doubled.size();
  const auto zero_count = static_cast<double>(signs.size() - doubled.size());
  const auto observed = static_cast<std::size_t>(std::lround(2 * result.positive));
  if (result.nonzero == 0) return result;

  const auto n = static_cast<double>(signs.size());
  double middle = n * (n + 1) / 4, variance = n * (n + 1) * (2 * n + 1) / 24 - ranks.tie_sum() / 48;
  if (zeros == Zeros::pratt) {
    middle -= zero_count * (zero_count + 1) / 4;
    // The zeros are one group of ties, whose correction their own term replaces.
    variance += (zero_count * zero_count * zero_count - zero_count) / 48;
    variance -= zero_count * (zero_count + 1) * (2 * zero_count + 1) / 24;
  }
  const double deviation = std::sqrt(variance), distance = result.positive - middle;
  result.normal = approximated(distance, deviation, 0);
  result.normal_corrected = approximated(distance, deviation, 0.5);

  result.exact = result.nonzero <= most_exact_pairs;
  if (!result.exact) {
    result.two_sided = result.normal;
    result.greater = normal_cdf(-distance / deviation);
    result.less = normal_cdf(distance / deviation);
    return result;
  }
  const std::vector<double> probability = sum_distribution(doubled);
  double at_least = 0, at_most = 0;
  // The smallest terms first, so that a small p keeps its digits.
  for (std::size_t s = probability.size(); s-- > observed;)
    at_least += probability[s];
  for (std::size_t s = 0; s <= observed; ++s)
    at_most += probability[s];
  result.greater = std::min(1.0, at_least);
  result.less = std::min(1.0, at_most);
  result.two_sided = std::min(1.0, 2 * std::min(result.greater, result.less));
  return result;
}

std::size_t signed_rank_index(std::size_t n, double tail) {
  if (n == 0) return 0;
  const auto pairs = static_cast<double>(n);
  if (n > most_exact_pairs) {
    const double middle = pairs * (pairs + 1) / 4;
    const double deviation = std::sqrt(pairs * (pairs + 1) * (2 * pairs + 1) / 24);
    return static_cast<std::size_t>(std::max(0.0, middle + normal_quantile(tail) * deviation));
  }
  std::vector<std::size_t> ranks(n);
  for (std::size_t i = 0; i < n; ++i)
    ranks[i] = i + 1;
  const std::vector<double> probability = sum_distribution(ranks);
  double sum = 0;
  std::size_t k = 0;
  while (k < probability.size() && (sum += probability[k]) <= tail)
    ++k;
  return k;
}

}  // namespace palpa::study
