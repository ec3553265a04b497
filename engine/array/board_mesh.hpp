// The physical boards of an array as a mesh: what hides the scene from cameras, and what the viewer draws.
#pragma once

#include "array/layout.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::array {

/// Two triangles per board, in the layout's frame, without thickness; counter-clockwise seen from the side it sounds
/// to. Empty for a layout of bare transducers.
geometry::Mesh board_mesh(const Layout& layout);

}  // namespace palpa::array
