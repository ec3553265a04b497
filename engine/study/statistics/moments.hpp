// Means, spreads and quantiles of a sample, and the correlation of two samples.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace palpa::study {

struct Interval {
  double low = 0, high = 0;
};

/// A sample of at least one value.
double mean(std::span<const double> values);
/// The standard deviation with n - 1; empty for fewer than two values.
std::optional<double> standard_deviation(std::span<const double> values);
/// There must be at least one value. If their number is even, it is the mean of the middle two.
double median(std::vector<double> values);

/// Student's 95 % interval of the mean; empty for fewer than two values.
std::optional<Interval> t_interval(std::span<const double> values);
/// The mean divided by the standard deviation (Cohen's d_z for differences); empty if the values do not differ.
std::optional<double> cohens_d(std::span<const double> values);

struct Correlation {
  double r = 0;
  double p = 0;                        ///< two-sided, by Student's t (spearman: or exact)
  std::optional<Interval> interval{};  ///< 95 %, by Fisher's z; only for more than three pairs and |r| < 1
};
/// Pearson's correlation; empty for fewer than three pairs, and if one of the samples does not vary.
std::optional<Correlation> pearson(std::span<const double> x, std::span<const double> y);
/// Pearson's correlation of the midranks. If these agree or are reversed, Student's t is infinite: p is then the share
/// of all orders of the ranks in which they do.
std::optional<Correlation> spearman(std::span<const double> x, std::span<const double> y);
/// p and interval of a Pearson correlation that is known from elsewhere.
Correlation correlation_of(double r, std::size_t pairs);

}  // namespace palpa::study
