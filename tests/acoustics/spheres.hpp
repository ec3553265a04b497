// Spheres of nearly even triangles.
#pragma once

#include "geometry/mesh.hpp"

namespace palpa::acoustics {

/// An icosahedron whose sides are divided by `divisions`, on a sphere about the origin: 20 divisions^2 faces.
geometry::Mesh icosphere(double radius, int divisions);

}  // namespace palpa::acoustics
