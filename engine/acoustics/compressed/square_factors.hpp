// Factors of squares along a matrix' diagonal: an approximate inverse of the whole matrix.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/compressed/hierarchical_matrix.hpp"

namespace palpa::acoustics {

class SquareFactors {
 public:
  /// The squares are the largest clusters of at most `most` vertices each. The same bytes for any number of threads.
  /// Throws failure() if a square is singular, GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
  SquareFactors(const HierarchicalMatrix& matrix, std::uint32_t most, const std::atomic<bool>* give_up = nullptr);

  /// Replaces `count` vectors y, in the matrix' order, by the squares' inverses (or transposed inverses) times x.
  void solve(Way way, const SplitVectors& x, std::size_t count, const SplitVectors& y) const;

 private:
  struct Square {
    HierarchicalMatrix::Square place;
    std::vector<std::complex<float>> factors;  // of the transposed matrix: LAPACK is column-major
    std::vector<int> pivots;
  };
  std::vector<Square> squares_;
};

}  // namespace palpa::acoustics
