// How deep a point lies inside a mesh, in double precision, by looking at every triangle.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Distance of `point` from the mesh's surface in metres, positive inside, negative outside. The mesh is closed and
/// faces outwards; inside is where its generalized winding number (Jacobson 2013; the solid angle by van Oosterom and
/// Strackee) is above one half.
double surface_depth(const Mesh& mesh, const Vec3& point);

}  // namespace palpa::geometry
