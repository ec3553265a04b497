// Spheres of nearly even triangles: what is known of them exactly is what solvers are measured against.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// An icosahedron whose sides are divided by `divisions`, on a sphere about the origin: 20 divisions^2 faces.
Mesh icosphere(double radius, int divisions);

}  // namespace palpa::geometry
