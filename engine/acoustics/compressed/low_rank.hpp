// Blocks of a matrix as short products, by adaptive cross approximation (Bebendorf 2000): each step evaluates one row
// and one column, and subtracts their product.
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "acoustics/compressed/matrix_entries.hpp"
#include "acoustics/compressed/split_kernels.hpp"

namespace palpa::acoustics {

inline std::size_t split_stride(std::size_t rows) {
  return (rows + split_lanes - 1) / split_lanes * split_lanes;
}

/// left right^T. `left` has the block's rows, `right` its columns as rows; both are split matrices (split_kernels.hpp)
/// with `rank` columns, zero beyond their rows.
struct LowRank {
  std::size_t rank = 0;
  std::vector<float> left, right;
};

/// Replaces `out`. The error is about `tolerance` times the block's Frobenius norm. Returns false if this needs a
/// larger rank than `most`. Throws GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
bool approximate(const MatrixEntries& entries, const ClusterPatches& rows, const ClusterPatches& columns,
                 double tolerance, std::size_t most, LowRank& out, const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
