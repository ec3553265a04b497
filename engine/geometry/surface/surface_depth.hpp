// Depth of a point inside a mesh, in double precision, found by testing every triangle.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Distance of `point` from the mesh's surface in metres, positive inside, negative outside. The mesh is closed and
/// faces outwards. A point is inside if its generalized winding number (Jacobson 2013; the solid angle by van Oosterom
/// and Strackee) is above one half.
double surface_depth(const Mesh& mesh, const Vec3& point);

}  // namespace palpa::geometry
