#include "study/tables/two_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "study/statistics/special.hpp"

namespace palpa::study {
namespace {

/// Whether two rows of counts have the same shares.
Difference rows_differ(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  double a_sum = 0, b_sum = 0, columns = 0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    a_sum += static_cast<double>(a[j]);
    b_sum += static_cast<double>(b[j]);
    columns += a[j] + b[j] > 0 ? 1 : 0;
  }
  Difference found;
  if (a_sum == 0 || b_sum == 0) return found;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const auto both = static_cast<double>(a[j] + b[j]);
    if (both == 0) continue;
    const double counts[]{static_cast<double>(a[j]), static_cast<double>(b[j])};
    const double sums[]{a_sum, b_sum};
    for (int k = 0; k < 2; ++k) {
      const double expected = both * sums[k] / (a_sum + b_sum);
      found.chi_square += (counts[k] - expected) * (counts[k] - expected) / expected;
      if (counts[k] > 0) found.likelihood_ratio += 2 * counts[k] * std::log(counts[k] / expected);
    }
  }
  found.degrees = columns - 1;
  return found;
}

void find_p(Difference& difference) {
  difference.likelihood_ratio = std::max(0.0, difference.likelihood_ratio);
  difference.p = chi_square_tail(difference.chi_square, difference.degrees);
  difference.p_likelihood_ratio = chi_square_tail(difference.likelihood_ratio, difference.degrees);
}

std::vector<std::uint64_t> row_of(const Confusion& table, std::size_t i) {
  const auto begin = table.counts.begin() + static_cast<std::ptrdiff_t>(i * table.size());
  return {begin, begin + static_cast<std::ptrdiff_t>(table.size())};
}

/// The shares off the diagonal.
std::vector<double> errors_of(std::span<const double> shares) {
  const auto shapes = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(shares.size()))));
  std::vector<double> errors;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (i % (shapes + 1) != 0) errors.push_back(shares[i]);
  }
  return errors;
}

}  // namespace

std::vector<double> shares_of(const Confusion& table) {
  std::vector<double> shares;
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t j = 0; j < table.size(); ++j)
      shares.push_back(share(table, i, j).value_or(0));
  }
  return shares;
}

double rms_difference(std::span<const double> a, std::span<const double> b) {
  double square = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    square += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(square / static_cast<double>(a.size()));
}

std::optional<Correlation> correlation_of_errors(std::span<const double> a, std::span<const double> b) {
  return pearson(errors_of(a), errors_of(b));
}

TwoTables compare(const Confusion& a, const Confusion& b) {
  TwoTables found;
  for (std::size_t i = 0; i < a.size(); ++i) {
    Difference& row = found.rows.emplace_back(rows_differ(row_of(a, i), row_of(b, i)));
    found.all.chi_square += row.chi_square;
    found.all.likelihood_ratio += row.likelihood_ratio;
    found.all.degrees += row.degrees;
    find_p(row);
  }
  find_p(found.all);
  const std::vector<double> a_shares = shares_of(a), b_shares = shares_of(b);
  found.rms = rms_difference(a_shares, b_shares);
  found.errors = correlation_of_errors(a_shares, b_shares);
  const std::uint64_t a_wrong = a.total() - a.correct(), b_wrong = b.total() - b.correct();
  found.correct = rows_differ({a.correct(), a_wrong}, {b.correct(), b_wrong});
  find_p(found.correct);
  return found;
}

}  // namespace palpa::study
