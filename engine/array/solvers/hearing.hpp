// The pressures of factors at the foci: through the small matrix, or of bounded transducers over the whole array.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <span>

#include "array/amplitudes.hpp"
#include "array/field/transfer.hpp"

namespace palpa::array {

/// |z|. std::abs handles numbers too large to be squared, at four times the cost; the solvers' numbers are far smaller.
inline double magnitude(const std::complex<double>& z) {
  return std::sqrt(std::norm(z));
}

/// The loudness of the weakest focus relative to its target; 0 if no focus has one. `loudness(j)` is that of focus j.
template <typename Loudness>
double weakest_of(std::span<const double> targets, const Loudness& loudness) {
  std::optional<double> weakest;
  for (std::size_t j = 0; j < targets.size(); ++j) {
    if (!(targets[j] > 0)) continue;
    const double part = loudness(j) / targets[j];
    weakest = weakest ? std::min(*weakest, part) : part;
  }
  return weakest.value_or(0);
}

/// p = R c: the pressure when amplitudes are proportional to the sums.
void hear(const FocusMatrix& matrix, std::span<const std::complex<double>> factors,
          std::span<std::complex<double>> pressure);

/// What a transducer plays for its sum: under `uniform` and `clamp` at most magnitude 1, under `uniform` also at least
/// 1.
std::complex<double> bounded(const std::complex<double>& sum, Constraint constraint);

/// p = G x, where x is what the transducers play for the sums B c.
void hear_bounded(const Columns& columns, Constraint constraint, std::span<const std::complex<double>> factors,
                  std::span<std::complex<double>> pressure);

}  // namespace palpa::array
