// The boundary elements' system of equations for large bodies: a compressed matrix (hierarchical_matrix.hpp) and
// iterations (block_gmres.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Pressures differ by about 0.05 % from those of the dense operator. It takes little more than twice the time and
/// memory for twice the faces. A solution takes about 12 products with the matrix. Throws GivenUp
/// (base/system/parallel.hpp) soon after `give_up` becomes true.
std::unique_ptr<SurfaceOperator> make_fast_operator(const Patches& body, double wave_number,
                                                    const std::atomic<bool>* give_up = nullptr);

/// An estimate of the memory that it takes, including a solution.
std::uint64_t fast_operator_bytes(const geometry::Mesh& body, double wave_number);

}  // namespace palpa::acoustics
