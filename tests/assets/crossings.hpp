// Does a surface run through itself?
#pragma once

#include <cstddef>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// How many pairs of an edge and a triangle that share no vertex cross. Triangles must be smaller than `cell`, metres.
std::size_t count_crossings(const geometry::Mesh& mesh, double cell);

}  // namespace palpa::assets
