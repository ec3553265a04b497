// Wilcoxon's signed-rank test of paired differences.
//
// The exact p is that of the permutation distribution: each difference could as well have had the other sign. It is
// right with ties and with zeros, because the distribution is computed for the ranks that the data have.
#pragma once

#include <cstddef>
#include <span>

namespace palpa::study {

/// The treatment of differences of zero.
enum class Zeros {
  drop,   ///< they are dropped before ranking (Wilcoxon)
  pratt,  ///< they are ranked, then dropped
};

struct SignedRank {
  std::size_t pairs = 0;        ///< all differences
  std::size_t nonzero = 0;      ///< those that are not zero
  double positive = 0;          ///< T+, the sum of the ranks of positive differences
  double negative = 0;          ///< T-
  bool exact = true;            ///< false: too many differences, all p are the normal approximation's
  double two_sided = 1;         ///< p; twice the smaller tail, at most 1
  double greater = 1;           ///< p of a T+ at least as large
  double less = 1;              ///< p of a T+ at least as small
  double normal = 1;            ///< two-sided p of the normal approximation with its correction for ties
  double normal_corrected = 1;  ///< the same with a continuity correction
};

/// The exact distribution is computed up to this many differences.
inline constexpr std::size_t most_exact_pairs = 200;

/// Without a difference other than zero, every p is 1.
SignedRank wilcoxon(std::span<const double> differences, Zeros zeros = Zeros::drop);

/// The largest k such that T+ of n untied differences is below k with a probability of at most `tail`; 0 if there is
/// no such k. The k-th smallest and k-th largest Walsh average bound an interval of 1 - 2 tail.
std::size_t signed_rank_index(std::size_t n, double tail);

}  // namespace palpa::study
