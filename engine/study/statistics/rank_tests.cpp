#include "study/statistics/rank_tests.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "study/statistics/ranks.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {
namespace {

/// The number of ways to choose `chosen` of the doubled ranks with each sum, as shares of all ways.
std::vector<double> sums_of(const std::vector<std::size_t>& doubled, std::size_t chosen) {
  const std::size_t most = std::accumulate(doubled.begin(), doubled.end(), std::size_t{0});
  std::vector<std::vector<double>> ways(chosen + 1, std::vector<double>(most + 1, 0));
  ways[0][0] = 1;
  for (const std::size_t rank : doubled) {
    for (std::size_t k = chosen; k > 0; --k) {
      for (std::size_t s = most; s >= rank; --s)
        ways[k][s] += ways[k - 1][s - rank];
    }
  }
  const double all = std::accumulate(ways[chosen].begin(), ways[chosen].end(), 0.0);
  for (double& way : ways[chosen])
    way /= all;
  return ways[chosen];
}

}  // namespace

Friedman friedman(const std::vector<std::vector<double>>& rows) {
  const auto n = static_cast<double>(rows.size()), k = static_cast<double>(rows[0].size());
  std::vector<double> sums(rows[0].size(), 0);
  double ties = 0;
  for (const std::vector<double>& row : rows) {
    const Ranks ranks = midranks(row);
    for (std::size_t j = 0; j < row.size(); ++j)
      sums[j] += ranks.of[j];
    ties += ranks.tie_sum();
  }
  double squares = 0;
  for (const double sum : sums)
    squares += (sum - n * (k + 1) / 2) * (sum - n * (k + 1) / 2);
  Friedman result{.people = rows.size(), .degrees = k - 1};
  const double scale = n * k * (k + 1) - ties / (k - 1);
  // Everybody's values are all equal: nothing differs.
  if (scale <= 0) return result;
  result.chi_square = 12 * squares / scale;
  result.p = chi_square_tail(result.chi_square, result.degrees);
  return result;
}

RankSum rank_sum(std::span<const double> a, std::span<const double> b) {
  std::vector<double> all(a.begin(), a.end());
  all.insert(all.end(), b.begin(), b.end());
  const Ranks ranks = midranks(all);
  RankSum result;
  std::vector<std::size_t> doubled;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i < a.size()) result.sum += ranks.of[i];
    doubled.push_back(static_cast<std::size_t>(std::lround(2 * ranks.of[i])));
  }
  if (a.empty() || b.empty()) return result;
  result.exact = all.size() <= most_exact_people;
  if (!result.exact) {
    const auto n = static_cast<double>(all.size()), m = static_cast<double>(a.size());
    const double variance = m * (n - m) / 12 * (n + 1 - ranks.tie_sum() / (n * (n - 1)));
    if (variance > 0) result.p = normal_two_sided((result.sum - m * (n + 1) / 2) / std::sqrt(variance));
    return result;
  }
  const std::vector<double> share = sums_of(doubled, a.size());
  const auto observed = static_cast<std::size_t>(std::lround(2 * result.sum));
  double at_least = 0, at_most = 0;
  for (std::size_t s = 0; s < share.size(); ++s) {
    if (s >= observed) at_least += share[s];
    if (s <= observed) at_most += share[s];
  }
  result.p = std::min(1.0, 2 * std::min(at_least, at_most));
  return result;
}

std::vector<double> holm(std::span<const double> p) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<double> corrected(p.size());
  double largest = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, std::min(1.0, p[order[i]] * static_cast<double>(p.size() - i)));
    corrected[order[i]] = largest;
  }
  return corrected;
}

}  // namespace palpa::study
