// Block GMRES (Saad and Schultz 1986; Vital 1990): solves a system for several right-hand sides at once, which share
// all directions of search. Directions that depend on the others are dropped.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/compressed/split_kernels.hpp"

namespace palpa::acoustics {

struct GmresSetting {
  double tolerance = 1e-4;  ///< of the residual
  std::uint32_t most_iterations = 200;
  std::size_t most_directions = 640;  ///< in memory; then it starts again from the solution so far
};

/// Replaces `count` vectors y by a map of the vectors x; x and y do not overlap.
using VectorMap = std::function<void(const SplitVectors& x, std::size_t count, const SplitVectors& y)>;

/// `precondition`: a map close to the inverse of `matrix`. `b` has `count` right-hand sides of stride() floats. `x` is
/// replaced by their solutions, or by the nearest vectors found: the residual tells which. A right-hand side of zero
/// has the solution zero. The same bytes for any number of threads. Throws GivenUp soon after `give_up` becomes true.
SolveReport block_gmres(const VectorMap& matrix, const VectorMap& precondition, const SplitVectors& b,
                        std::size_t count, const SplitVectors& x, const GmresSetting& setting,
                        const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
