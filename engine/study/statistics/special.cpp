#include "study/statistics/special.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpa::study {
namespace {

constexpr double tiny = 1e-300;
constexpr double precision = 1e-16;
constexpr int most_terms = 100'000;

/// The continued fraction of the incomplete beta function, by Lentz's method.
double beta_fraction(double a, double b, double x) {
  double c = 1, d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < tiny ? tiny : d);
  double value = d;
  const auto step = [&](double term) {
    d = 1 + term * d;
    d = 1 / (std::abs(d) < tiny ? tiny : d);
    c = 1 + term / c;
    if (std::abs(c) < tiny) c = tiny;
    value *= c * d;
    return std::abs(c * d - 1) > precision;
  };
  for (int m = 1; m < most_terms; ++m) {
    step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
    if (!step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)))) break;
  }
  return value;
}

/// The upper regularised incomplete gamma function Q(a, x).
double gamma_tail(double a, double x) {
  if (x <= 0) return 1;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (int n = 1; n < most_terms && term > sum * precision; ++n)
      sum += term *= x / (a + n);
    return std::max(0.0, 1 - front * sum);
  }
  double b = x + 1 - a, c = 1 / tiny, d = 1 / b, value = d;
  for (int n = 1; n < most_terms; ++n) {
    const double term = -n * (n - a);
    b += 2;
    d = term * d + b;
    d = 1 / (std::abs(d) < tiny ? tiny : d);
    c = b + term / c;
    if (std::abs(c) < tiny) c = tiny;
    value *= c * d;
    if (std::abs(c * d - 1) <= precision) break;
  }
  return front * value;
}

/// Where an increasing function of [low, high] reaches `wanted`.
template <typename Function>
double bisected(double low, double high, double wanted, const Function& function) {
  for (int i = 0; i < 200; ++i) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (function(middle) < wanted ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

}  // namespace

double normal_two_sided(double z) {
  return std::erfc(std::abs(z) / std::numbers::sqrt2);
}

double beta_cdf(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
  return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

double beta_quantile(double a, double b, double p) {
  return bisected(0, 1, p, [&](double x) { return beta_cdf(a, b, x); });
}

double t_two_sided(double t, double degrees) {
  return beta_cdf(degrees / 2, 0.5, degrees / (degrees + t * t));
}

double t_critical(double tail, double degrees) {
  const double x = beta_quantile(degrees / 2, 0.5, 2 * tail);
  return std::sqrt(degrees * (1 - x) / x);
}

double chi_square_tail(double value, double degrees) {
  return degrees <= 0 ? 1 : gamma_tail(degrees / 2, value / 2);
}

double binomial_tail(std::uint64_t k, std::uint64_t n, double p) {
  if (k == 0) return 1;
  if (k > n) return 0;
  return beta_cdf(static_cast<double>(k), static_cast<double>(n - k) + 1, p);
}

}  // namespace palpa::study
