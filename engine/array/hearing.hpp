// What foci hear of factors: through the small matrix, and of bounded transducers over the whole array.
#pragma once

#include <cmath>
#include <complex>
#include <span>

#include "array/constraint.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

/// |z|. std::abs minds numbers too large to be squared, at four times the price; solvers' are nowhere near.
inline double magnitude(const std::complex<double>& z) {
  return std::sqrt(std::norm(z));
}

/// p = R c: what sounds where amplitudes are in proportion to the sums.
void hear(const FocusMatrix& matrix, std::span<const std::complex<double>> factors,
          std::span<std::complex<double>> pressure);

/// What a transducer does of its sum: under `uniform` and `clamp` nothing above 1, under `uniform` nothing below it.
std::complex<double> bounded(const std::complex<double>& sum, Constraint constraint);

/// p = G x, x being what the transducers do of the sums B c.
void hear_bounded(const Columns& columns, Constraint constraint, std::span<const std::complex<double>> factors,
                  std::span<std::complex<double>> pressure);

}  // namespace palpa::array
