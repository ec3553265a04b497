#include "array/solvers/back_propagation.hpp"

#include <algorithm>
#include <cassert>

#include "array/solvers/hearing.hpp"

namespace palpa::array {

using Complex = std::complex<double>;

void propagated_factors(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains,
                        Constraint constraint, std::span<Complex> factors, std::vector<Complex>& pressure) {
  const std::size_t foci = matrix.foci;
  assert(gains.size() == foci && factors.size() == foci);
  pressure.resize(foci);
  for (std::size_t j = 0; j < foci; ++j) {
    const Complex sound = columns.transducers > 0 ? Complex(columns.cosine[j], -columns.sine[j]) : Complex(1);
    factors[j] = gains[j] * sound;
  }
  for (std::uint32_t step = 0; step < propagation_steps; ++step) {
    if (constraint == Constraint::normalise) {
      hear(matrix, factors, pressure);
    } else {
      hear_bounded(columns, constraint, factors, pressure);
    }
    Complex common = 0;  // what all factors turned
    for (std::size_t j = 0; j < foci; ++j) {
      const double size = magnitude(pressure[j]);
      pressure[j] = size > 0 ? gains[j] / size * pressure[j] : factors[j];
      common += std::conj(factors[j]) * pressure[j];
    }
    const double turned = magnitude(common);
    const Complex back = turned > 0 ? std::conj(common) / turned : Complex(1);
    double moved = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      moved = std::max(moved, magnitude(back * pressure[j] - factors[j]));
      factors[j] = pressure[j];
    }
    if (moved < propagation_still) return;
  }
}

}  // namespace palpa::array
