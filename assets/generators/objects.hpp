// The paper's four objects (section IV-A): each with its top at y = 0 on the y axis and its body below.
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// Sides of 40 mm. 8 vertices, 12 triangles.
geometry::Mesh make_cube();

/// Half a ball of radius 20 mm: flat side down at y = -20 mm, the dome's pole at the origin. Every vertex lies on the
/// sphere (to a float's precision); the dome is strictly convex and nowhere more than 30 micrometres inside the sphere.
geometry::Mesh make_semi_sphere();

/// Base 40 mm square, 45 degrees between opposite faces, so 48.28 mm high. 5 vertices, 6 triangles.
geometry::Mesh make_pyramid();

/// The pyramid's profile drawn out 40 mm along z; its ridge runs along z. 6 vertices, 8 triangles.
geometry::Mesh make_prism();

}  // namespace palpa::assets
