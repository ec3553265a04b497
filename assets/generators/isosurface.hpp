// A closed triangle mesh around the inside of a level set, by marching tetrahedra.
#pragma once

#include <functional>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// Negative inside.
using Field = std::function<double(const Vec3&)>;

/// The surface field = 0 within `box`, outside of which the field must be positive, on a grid of cubes of side `cell`,
/// each cut into six tetrahedra. It is always closed, manifold and consistently oriented. The field's magnitude must be
/// at most twice the distance to the surface (a distance is), so that empty space can be skipped. Two surfaces that are
/// always at least sqrt(3) cells apart stay two. Vertices lie on the grid's edges, but are kept off their ends, so they
/// are up to a tenth of an edge off the surface: the mesh is an input of remesh(), not a final result.
geometry::Mesh isosurface(const Field& field, const Box& box, double cell);

}  // namespace palpa::assets
