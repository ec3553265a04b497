// The physical boards of an array as a mesh. They hide the scene from cameras, and the viewer draws them.
#pragma once

#include "array/layouts/layout.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::array {

/// Two triangles per board, in the layout's frame, without thickness; counter-clockwise seen from the sounding side.
/// Empty for a layout of bare transducers.
geometry::Mesh board_mesh(const Layout& layout);

}  // namespace palpa::array
