// Spheres of nearly equal triangles. Exact solutions for spheres are known, so they serve as tests of solvers.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// An icosahedron whose edges are divided by `divisions`, projected onto a sphere about the origin: 20 divisions^2
/// faces.
Mesh icosphere(double radius, int divisions);

}  // namespace palpa::geometry
