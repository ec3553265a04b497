// Distribution functions that the statistics of a study need: Student's t, chi-square, binomial and beta. They
// agree with published tables to about twelve digits.
#pragma once

#include <cstdint>

namespace palpa::study {

/// Both tails of the standard normal distribution (base/normal.hpp) beyond |z|.
double normal_two_sided(double z);

/// The regularised incomplete beta function I_x(a, b), for a, b > 0 and 0 <= x <= 1.
double beta_cdf(double a, double b, double x);
/// x with beta_cdf(a, b, x) = p.
double beta_quantile(double a, double b, double p);

/// Both tails beyond |t| of Student's t.
double t_two_sided(double t, double degrees);
/// The value that t exceeds with the probability `tail`, for 0 < tail < 0.5.
double t_critical(double tail, double degrees);

/// The probability that chi-square exceeds `value`. 1 for no degrees of freedom.
double chi_square_tail(double value, double degrees);

/// The probability of at least `k` of `n`, each with the probability p.
double binomial_tail(std::uint64_t k, std::uint64_t n, double p);

}  // namespace palpa::study
