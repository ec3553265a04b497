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
  /// Takes `matrix`, size x size by rows. LU with partial pivoting; the same bytes for any number of threads. Throws
  /// failure() where the matrix is singular, GivenUp (base/parallel.hpp) soon after `give_up` became true.
  DenseLu(std::vector<std::complex<float>> matrix, std::size_t size, const std::atomic<bool>* give_up = nullptr);

  /// Replaces right-hand sides, one after the other in `columns`, by their solutions.
  void solve(Way way, std::span<std::complex<float>> columns) const;

 private:
  std::size_t size_;
  std::vector<std::complex<float>> factors_;  // of the transposed matrix: LAPACK counts by columns
  std::vector<int> pivots_;
};

}  // namespace palpa::acoustics
