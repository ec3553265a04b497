// Small faults of meshes that are repaired rather than refused.
#pragma once

#include <cstddef>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

struct Dropped {
  std::size_t duplicates = 0;    ///< faces that existed already
  std::size_t back_to_back = 0;  ///< pairs of the same face in both orientations: a wall of no thickness inside a solid
};

/// Removes faces with the same three vertices as another: all but the first of equal ones, both of opposite ones.
Dropped drop_duplicates(Mesh& mesh);

/// Flips the longest edge of triangles less than `width` metres wide whose third corner lies beside that edge. The
/// corner then belongs to the former neighbour across the edge, and the surface moves by less than `width`. `mesh` is
/// closed and oriented and stays so. Returns the number of flipped edges; a needle that no flip would widen stays.
std::size_t turn_needles(Mesh& mesh, double width);

}  // namespace palpa::geometry
