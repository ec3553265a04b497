// Small faults of meshes that are mended rather than refused.
#pragma once

#include <cstddef>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

struct Dropped {
  std::size_t duplicates = 0;    ///< faces that were there already
  std::size_t back_to_back = 0;  ///< pairs of the same face, once each way round: a wall of no thickness inside a solid
};

/// Leaves out faces with the same three vertices as another: of equal ones all but the first, of opposite ones both.
Dropped drop_duplicates(Mesh& mesh);

/// Turns the longest edge of triangles less than `width` metres wide whose third corner lies beside it: the corner then
/// belongs to what was the neighbour across, and the surface moves by less than `width`. `mesh` is closed and oriented
/// and stays so. Gives the number of edges turned; a needle that no turn would widen stays.
std::size_t turn_needles(Mesh& mesh, double width);

}  // namespace palpa::geometry
