#include "base/normal.hpp"

#include <cmath>
#include <numbers>

namespace palpa {

double normal_density(double z) {
  return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
}

double normal_cdf(double z) {
  return std::erfc(-z / std::numbers::sqrt2) / 2;
}

namespace {

/// Abramowitz and Stegun 26.2.23: within 4.5e-4 of the quantile, for p < 0.5.
double near_quantile(double p) {
  const double t = std::sqrt(-2 * std::log(p));
  return (2.515517 + t * (0.802853 + t * 0.010328)) / (1 + t * (1.432788 + t * (0.189269 + t * 0.001308))) - t;
}

/// Newton's step with Halley's correction: an error e becomes (z^2 + 2) / 12 e^3.
double nearer_quantile(double z, double p) {
  const double error = (normal_cdf(z) - p) / normal_density(z);
  return z - error / (1 + z * error / 2);
}

}  // namespace

double normal_quantile(double p) {
  if (p == 0.5) return 0;
  if (p > 0.5) return -normal_quantile(1 - p);
  double z = near_quantile(p);
  for (int i = 0; i < 4; ++i)
    z = nearer_quantile(z, p);
  return z;
}

float normal_quantile_float(double p) {
  if (p == 0.5) return 0;
  if (p > 0.5) return -normal_quantile_float(1 - p);
  const double z = nearer_quantile(near_quantile(p), p), error = 1e-11 * (z * z + 2);
  const auto low = static_cast<float>(z - error);
  return low == static_cast<float>(z + error) ? low : static_cast<float>(normal_quantile(p));
}

}  // namespace palpa
