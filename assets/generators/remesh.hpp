// Near-equilateral triangles on a level set.
#pragma once

#include "assets/generators/isosurface.hpp"

namespace palpa::assets {

/// Wanted edge length at a place.
using Sizing = std::function<double(const Vec3&)>;

/// Botsch and Kobbelt, "A remeshing approach to multiresolution modeling" (2004): splits long edges, collapses short
/// ones, evens out valences by flips, relaxes vertices along the surface and puts them back onto field = 0. `mesh` must
/// be closed and manifold, and remains so; its topology is kept.
geometry::Mesh remesh(geometry::Mesh mesh, const Field& field, const Sizing& sizing, int rounds = 6);

}  // namespace palpa::assets
