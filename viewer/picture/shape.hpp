// A mesh as the renderer needs it: vertices with shading normals, triangles of them, and edges that may be lines.
#pragma once

#include <span>
#include <vector>

#include "drawing/colour.hpp"
#include "geometry/mesh/mesh.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/picture/outline.hpp"

namespace palpa::viewer {

struct Shape {
  std::vector<shader::ViewVertex> vertices;  ///< without duplicates
  std::vector<std::uint32_t> corners;  ///< three per triangle, in an order in which a device shades few vertices twice
  EdgeNet edges;                       ///< creases, open edges, folds of smooth surfaces; none between coplanar faces
};

/// `mesh` must be welded. Triangles without area are left out. Faces that meet at less than 0.52 radians shade
/// smoothly. A crease is drawn if it closes, or if together with those that it meets it is at least a quarter as long
/// as the object. The short folds of a scan are not drawn. `colours`, if not empty, are the vertices' colours: the
/// shape's corners then have their own colours.
Shape make_shape(const geometry::Mesh& mesh, std::span<const drawing::Colour> colours = {});

}  // namespace palpa::viewer
