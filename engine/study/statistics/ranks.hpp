// Ranks with ties.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace palpa::study {

struct Ranks {
  std::vector<double> of;           ///< rank of each value, from 1; equal values share the mean of their ranks
  std::vector<std::uint64_t> tied;  ///< sizes of the groups of equal values, groups of one left out

  /// The sum of t^3 - t over the groups, for the variance of rank statistics.
  double tie_sum() const;
};

/// Values are equal if they are the same double. Differences of counts must therefore be computed from whole numbers
/// and divided once: 0.70 - 0.45 and 0.80 - 0.55 differ in their last bit.
Ranks midranks(std::span<const double> values);

}  // namespace palpa::study
