// The choice between the dense and the fast operator, by the size of the body.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Bodies with more vertices than this get the fast operator, unless it would need more memory than the dense one.
inline constexpr std::size_t most_dense_vertices = 3000;

/// Throws GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
std::unique_ptr<SurfaceOperator> make_operator(const Patches& body, double wave_number,
                                               const std::atomic<bool>* give_up = nullptr);

/// The memory that it takes (surface_operator.hpp, fast_operator.hpp).
std::uint64_t operator_bytes(const geometry::Mesh& body, double wave_number);

}  // namespace palpa::acoustics
