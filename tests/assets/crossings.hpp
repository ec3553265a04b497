// Counts where a surface crosses itself.
#pragma once

#include <cstddef>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// The number of crossing pairs of an edge and a triangle that share no vertex. Triangles must be smaller than `cell`,
/// metres.
std::size_t count_crossings(const geometry::Mesh& mesh, double cell);

}  // namespace palpa::assets
