// The Hodges-Lehmann estimate of a paired difference, and an interval by the bootstrap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "study/statistics/moments.hpp"

namespace palpa::study {

struct HodgesLehmann {
  double estimate = 0;                 ///< the median of all Walsh averages (d_i + d_j) / 2, i <= j
  std::optional<Interval> interval{};  ///< at least 95 %; empty for fewer than six differences
};
/// There must be at least one difference.
HodgesLehmann hodges_lehmann(std::span<const double> differences);

/// The number of resamples for a sample of that size: 100,000, fewer for more than 200 values.
std::uint32_t bootstrap_resamples(std::size_t values);
/// 95 % percentile interval of the mean. It resamples the values, which must be one per person: resampling trials would
/// pretend that all trials are independent. Empty for fewer than two values.
std::optional<Interval> bootstrap_mean(std::span<const double> values, std::uint64_t seed, std::uint32_t resamples);

}  // namespace palpa::study
