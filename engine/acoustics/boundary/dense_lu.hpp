// A square matrix, factored once, for any number of right-hand sides.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/boundary/surface_operator.hpp"

namespace palpa::acoustics {

class DenseLu {
 public:
  /// Takes `matrix`, size x size, row-major. LU with partial pivoting; the same bytes for any number of threads. Throws
  /// failure() if the matrix is singular, GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
  DenseLu(std::vector<std::complex<float>> matrix, std::size_t size, const std::atomic<bool>* give_up = nullptr);

  /// Replaces the right-hand sides in `columns`, one after the other, by their solutions.
  void solve(Way way, std::span<std::complex<float>> columns) const;

 private:
  std::size_t size_;
  std::vector<std::complex<float>> factors_;  // of the transposed matrix: LAPACK is column-major
  std::vector<int> pivots_;
};

}  // namespace palpa::acoustics
