// A mesh as the renderer wants it: vertices with shading normals, triangles of them, and edges that may be lines.
#pragma once

#include <span>
#include <vector>

#include "drawing/colour.hpp"
#include "geometry/mesh/mesh.hpp"
#include "shaders/viewer/view_scene.h"
#include "viewer/picture/outline.hpp"

namespace palpa::viewer {

struct Shape {
  std::vector<shader::ViewVertex> vertices;  ///< no two the same
  std::vector<std::uint32_t> corners;  ///< three per triangle, in an order in which a device shades few vertices twice
  EdgeNet edges;                       ///< creases, open edges, and folds of smooth surfaces; none where coplanar
};

/// `mesh` welded; triangles without area are left out. Faces that meet at less than `crease` radians shade smoothly.
/// Creases are drawn where they close or are, with those they meet, at least a quarter as long as the object: not the
/// short folds of a scan. `colours`, where not empty, are the vertices': the shape's corners then have colours of their
/// own.
inline constexpr double usual_crease = 0.52;
Shape make_shape(const geometry::Mesh& mesh, double crease = usual_crease,
                 std::span<const drawing::Colour> colours = {});

}  // namespace palpa::viewer
