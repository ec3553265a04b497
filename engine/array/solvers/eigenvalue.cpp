#include "array/solvers/eigenvalue.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "array/solvers/hearing.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// Solves the system in place by elimination, with the largest entry of a column as its pivot. Rows of `rest.size()`.
void solve(std::span<Complex> system, std::span<Complex> rest) {
  const std::size_t rows = rest.size();
  for (std::size_t k = 0; k < rows; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < rows; ++i) {
      if (std::norm(system[i * rows + k]) > std::norm(system[pivot * rows + k])) pivot = i;
    }
    for (std::size_t j = 0; j < rows && pivot != k; ++j)
      std::swap(system[k * rows + j], system[pivot * rows + j]);
    std::swap(rest[k], rest[pivot]);
    if (std::norm(system[k * rows + k]) == 0) continue;
    for (std::size_t i = k + 1; i < rows; ++i) {
      const Complex part = system[i * rows + k] / system[k * rows + k];
      for (std::size_t j = k; j < rows; ++j)
        system[i * rows + j] -= part * system[k * rows + j];
      rest[i] -= part * rest[k];
    }
  }
  for (std::size_t k = rows; k-- > 0;) {
    for (std::size_t j = k + 1; j < rows; ++j)
      rest[k] -= system[k * rows + j] * rest[j];
    rest[k] = std::norm(system[k * rows + k]) > 0 ? rest[k] / system[k * rows + k] : 0;
  }
}

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
  solve(scratch.system, factors);
}

}  // namespace palpa::array
