// The octree of a surface's cells; see surface.hpp for the method.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/surface/surface.hpp"
#include "geometry/surface/surface_triangles.hpp"

namespace palpa::geometry {

struct SurfaceCells {
  Vec3 low{0};
  double cell_m = 0;
  glm::uvec3 grid{0};
  std::uint32_t longest = 0;  ///< maximum number of triangles in a cell
  std::vector<shader::SurfaceCell> cells;
  std::vector<std::uint32_t> runs;
};

/// `triangles` are in the order of `bvh`, the mesh's tree; `box` surrounds them. Both are relative to `centre`.
SurfaceCells make_surface_cells(const Bvh& bvh, const SurfaceTriangles& triangles, const Vec3& centre, const Box& box,
                                const SurfaceOptions& options);

/// Whether a point whose nearest triangle is this one is inside.
bool is_inside(const shader::SurfaceTriangle& triangle, const shader::SurfaceSigns& signs,
               std::span<const shader::vec4> corners, const glm::vec3& p);

}  // namespace palpa::geometry
