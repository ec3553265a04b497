// The true surface of a solid in a form that answers "inside? how deep?" at a cost that does not grow with the number
// of faces: every triangle in its own axes, and an octree of cells, each with the triangles that can be the nearest one
// somewhere in it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "shaders/touch/contacts/surface.h"

namespace palpa::geometry {

struct SurfaceOptions {
  double reach_m = 1.5e-3;  ///< delta: points inside and nearer to the surface than this get their exact depth
  bool deep = false;        ///< deeper points also get a depth, at most 2 % too large
  /// The grid has about four cells per triangle, but at least this many. Fewer cells are made faster and give the same
  /// results, but queries are slower.
  std::uint32_t least_cells = 4096;
  /// Limits of the steps (visited nodes of a tree of boxes) for filling the grid: per cell, per triangle, and in
  /// addition to these. The first two are doubled if deep points get a depth. A step takes 10 to 20 ns. A lumpy ball of
  /// 1,000,000 triangles takes less than a third of the limit. A grid is refused before it is filled if a sample of its
  /// cells predicts more than one and a half times the limit.
  std::uint64_t steps_per_cell = 300;
  std::uint64_t steps_per_triangle = 400;
  std::uint64_t spare_steps = 50'000'000;
};

/// Built once, shared by copies, never changed. All positions are relative to `centre`, in single precision.
struct Surface {
  Vec3 centre{0};             ///< metres, in the mesh's coordinates; single precision holds it exactly
  Vec3 low{0}, high{0};       ///< the box that the grid fills, relative to the centre
  double cell_m = 0;          ///< side of the grid's cells
  glm::uvec3 grid{0};         ///< number of cells along each axis, at most 1023
  std::uint32_t longest = 0;  ///< maximum number of triangles that a point is tested against
  SurfaceOptions options;
  std::span<const shader::SurfaceCell> cells;  ///< the grid, x fastest, then the children of divided cells
  std::span<const std::uint32_t> runs;
  std::span<const shader::SurfaceTriangle> triangles;
  std::span<const shader::SurfaceSigns> signs;  ///< one per triangle
  std::span<const shader::vec4> corners;        ///< pseudonormals
  std::shared_ptr<const void> memory;           ///< owns the memory of the spans

  bool empty() const { return triangles.empty(); }
};

/// `mesh` is welded, closed, oriented outwards and free of self-intersections, as make_solids() accepts it. Method: a
/// triangle T is left out of a cell if some point q of the surface is nearer than T at all eight corners of the cell.
/// For fixed q, d(p, T)^2 - |p - q|^2 is a minimum of linear functions of p, hence concave, hence least at a corner.
/// Rounding is allowed for, so that the least float distance over a cell's triangles is the least over all, bit for
/// bit. Uses all cores; the result is the same for any number of them. A million faces take about ten seconds and 500
/// MB. Throws failure() if the boxes of the triangles overlap so much (long ones, side by side along a diagonal) that
/// finding the nearest ones costs more than the options allow.
Surface make_surface(const Mesh& mesh, const SurfaceOptions& options);

/// The place of a point relative to the surface.
enum class Region { outside, shell, deep };
struct Place {
  Region region = Region::outside;
  float depth_m = 0;           ///< for points inside; 0 for deep points of a surface without deep depths
  std::uint32_t triangle = 0;  ///< the nearest one, in the order of Surface; unset if depth_m is 0
};

/// The twin of shaders/touch/contacts/surface_query.glsl: the place of a point `p` (relative to the centre) for `delta`
/// <= the surface's reach.
Place find_place(const Surface& surface, const glm::vec3& p, float delta);

}  // namespace palpa::geometry
