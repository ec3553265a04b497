#include "study/tables/dprime.hpp"

#include <algorithm>
#include <cmath>

#include "base/normal.hpp"
#include "study/statistics/special.hpp"

namespace palpa::study {

double correct_of_dprime(double dprime, std::uint32_t alternatives) {
  // The trapezoidal rule: for a smooth function that vanishes at both ends, it is exact to rounding.
  constexpr double reach = 9, step = 0.06;
  constexpr int steps = static_cast<int>(2 * reach / step);
  double sum = 0;
  for (int i = 0; i <= steps; ++i) {
    const double from_mean = -reach + i * step;
    sum += normal_density(from_mean) * std::pow(normal_cdf(dprime + from_mean), alternatives - 1);
  }
  return sum * step;
}

double dprime_of_share(double correct, std::uint32_t alternatives) {
  // The secant method with a bracket (Illinois).
  double low = -10, high = 20;
  double at_low = correct_of_dprime(low, alternatives) - correct, at_high = 1 - correct;
  double middle = 0;
  for (int i = 0; i < 200 && high - low > 1e-13; ++i) {
    middle = (low * at_high - high * at_low) / (at_high - at_low);
    const double here = correct_of_dprime(middle, alternatives) - correct;
    if (std::abs(here) < 1e-15) break;
    if (here > 0) {
      high = middle;
      at_high = here;
      at_low /= 2;
    } else {
      low = middle;
      at_low = here;
      at_high /= 2;
    }
  }
  return middle;
}

std::optional<double> dprime(std::uint64_t correct, std::uint64_t trials, std::uint32_t alternatives) {
  if (trials == 0 || alternatives < 2) return std::nullopt;
  const auto n = static_cast<double>(trials);
  return dprime_of_share(std::clamp(static_cast<double>(correct) / n, 0.5 / n, 1 - 0.5 / n), alternatives);
}

std::optional<double> dprime_of_pair(const Confusion& table, std::size_t a, std::size_t b) {
  const auto aa = static_cast<double>(table.at(a, a)), ab = static_cast<double>(table.at(a, b));
  const auto ba = static_cast<double>(table.at(b, a)), bb = static_cast<double>(table.at(b, b));
  if (aa + ab == 0 || ba + bb == 0) return std::nullopt;
  return normal_quantile((aa + 0.5) / (aa + ab + 1)) - normal_quantile((ba + 0.5) / (ba + bb + 1));
}

}  // namespace palpa::study
