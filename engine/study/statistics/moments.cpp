#include "study/statistics/moments.hpp"

#include <algorithm>
#include <cmath>

#include "base/normal.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {

double mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values)
    sum += value;
  return sum / static_cast<double>(values.size());
}

std::optional<double> standard_deviation(std::span<const double> values) {
  if (values.size() < 2) return std::nullopt;
  const double middle = mean(values);
  double squares = 0;
  for (const double value : values)
    squares += (value - middle) * (value - middle);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double median(std::vector<double> values) {
  const std::size_t half = values.size() / 2;
  std::ranges::sort(values);
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

std::optional<Interval> t_interval(std::span<const double> values) {
  const std::optional<double> deviation = standard_deviation(values);
  if (!deviation) return std::nullopt;
  const auto n = static_cast<double>(values.size());
  const double middle = mean(values), half = t_critical(0.025, n - 1) * *deviation / std::sqrt(n);
  return Interval{middle - half, middle + half};
}

std::optional<double> cohens_d(std::span<const double> values) {
  const std::optional<double> deviation = standard_deviation(values);
  // Rounding leaves a deviation of some 1e-17 where all values are the same.
  if (!deviation || *deviation < 1e-12) return std::nullopt;
  return mean(values) / *deviation;
}

std::optional<Correlation> pearson(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 3 || x.size() != y.size()) return std::nullopt;
  const double x_mean = mean(x), y_mean = mean(y);
  double xx = 0, yy = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - x_mean) * (x[i] - x_mean);
    yy += (y[i] - y_mean) * (y[i] - y_mean);
    xy += (x[i] - x_mean) * (y[i] - y_mean);
  }
  const auto n = static_cast<double>(x.size());
  if (xx <= n * 1e-24 || yy <= n * 1e-24) return std::nullopt;
  return correlation_of(std::clamp(xy / std::sqrt(xx * yy), -1.0, 1.0), x.size());
}

namespace {

/// The share of all orders of these ranks in which they agree, or are reversed.
double share_of_agreeing_orders(const Ranks& ranks) {
  std::vector<double> sorted = ranks.of;
  std::ranges::sort(sorted);
  const std::size_t n = sorted.size();
  double share = 1;
  bool symmetric = true;
  for (std::size_t i = 0, run = 0; i < n; ++i) {
    run = i > 0 && sorted[i] == sorted[i - 1] ? run + 1 : 1;
    share *= static_cast<double>(run) / static_cast<double>(i + 1);
    symmetric = symmetric && sorted[i] + sorted[n - 1 - i] == static_cast<double>(n) + 1;
  }
  return symmetric ? 2 * share : share;
}

}  // namespace

std::optional<Correlation> spearman(std::span<const double> x, std::span<const double> y) {
  const Ranks x_ranks = midranks(x), y_ranks = midranks(y);
  std::optional<Correlation> found = pearson(x_ranks.of, y_ranks.of);
  if (!found) return found;
  bool same = true, reversed = true;
  for (std::size_t i = 0; i < x.size(); ++i) {
    same = same && x_ranks.of[i] == y_ranks.of[i];
    reversed = reversed && x_ranks.of[i] + y_ranks.of[i] == static_cast<double>(x.size()) + 1;
  }
  if (same || reversed) *found = {.r = same ? 1.0 : -1.0, .p = share_of_agreeing_orders(x_ranks)};
  return found;
}

Correlation correlation_of(double r, std::size_t pairs) {
  const auto n = static_cast<double>(pairs);
  Correlation found{.r = r};
  const double rest = 1 - r * r;
  found.p = rest <= 0 ? 0 : t_two_sided(r * std::sqrt((n - 2) / rest), n - 2);
  if (pairs > 3 && rest > 0) {
    const double half = normal_quantile(0.975) / std::sqrt(n - 3);
    found.interval = Interval{std::tanh(std::atanh(r) - half), std::tanh(std::atanh(r) + half)};
  }
  return found;
}

}  // namespace palpa::study
