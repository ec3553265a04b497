#include "array/solvers/eigenvalue.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "array/solvers/complex_system.hpp"
#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Fills the eigenvector; its entries are relative to the largest.
void find_vector(const FocusMatrix& matrix, std::span<const double> gains, EigenvalueScratch& scratch) {
  const std::size_t foci = gains.size();
  for (std::uint32_t step = 0; step < eigenvalue_steps; ++step) {
    double largest = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      Complex sum = 0;
      for (std::size_t k = 0; k < foci; ++k) {
        if (matrix.alone(k) > 0) sum += matrix.at(j, k) * (gains[k] / matrix.alone(k)) * scratch.vector[k];
      }
      scratch.next[j] = sum;
      largest = std::max(largest, magnitude(sum));
    }
    if (!(largest > 0)) return;
    double moved = 0;
    for (std::size_t j = 0; j < foci; ++j) {
      scratch.next[j] /= largest;
      moved = std::max(moved, magnitude(scratch.next[j] - scratch.vector[j]));
    }
    std::swap(scratch.vector, scratch.next);
    if (moved < eigenvalue_still) return;
  }
}

}  // namespace

void eigenvalue_factors(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains,
                        std::span<Complex> factors, EigenvalueScratch& scratch) {
  const std::size_t foci = matrix.foci;
  assert(gains.size() == foci && factors.size() == foci);
  scratch.vector.resize(foci);
  scratch.next.resize(foci);
  scratch.system.resize(foci * foci);
  for (std::size_t j = 0; j < foci; ++j)
    scratch.vector[j] = columns.transducers > 0 ? Complex(columns.cosine[j], -columns.sine[j]) : Complex(1);
  find_vector(matrix, gains, scratch);
  double mean = 0;
  for (std::size_t j = 0; j < foci; ++j)
    mean += std::max(0.0, matrix.alone(j)) / static_cast<double>(foci);
  for (std::size_t j = 0; j < foci; ++j) {
    for (std::size_t k = 0; k < foci; ++k)
      scratch.system[j * foci + k] = (mean > 0 ? matrix.at(j, k) / mean : 0) + (j == k ? eigenvalue_ridge : 0);
    const double size = magnitude(scratch.vector[j]);
    factors[j] = size > 0 ? gains[j] / size * scratch.vector[j] : Complex(gains[j]);
  }
  solve_complex(scratch.system, factors);
}

}  // namespace palpa::array
