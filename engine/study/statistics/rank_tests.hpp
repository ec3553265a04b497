// Tests of ranks other than the signed-rank test, and the correction for several tests.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace palpa::study {

struct Friedman {
  std::size_t people = 0;
  double chi_square = 0;  ///< corrected for ties
  double degrees = 0;
  double p = 1;
};
/// Whether the columns differ. Each row is one person's values, one per method; at least two rows and two columns.
Friedman friedman(const std::vector<std::vector<double>>& rows);

struct RankSum {
  double sum = 0;     ///< of the ranks of `a` among all
  bool exact = true;  ///< false: more than most_exact_people, the normal approximation
  double p = 1;       ///< two-sided
};
inline constexpr std::size_t most_exact_people = 60;
/// Wilcoxon's rank-sum test of two groups of people, by the permutation distribution of the ranks that the data have.
RankSum rank_sum(std::span<const double> a, std::span<const double> b);

/// The p of several tests, corrected by Holm's method, in the same order.
std::vector<double> holm(std::span<const double> p);

}  // namespace palpa::study
