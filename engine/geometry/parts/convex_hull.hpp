// The convex hull of a set of points. Turns the pieces of a decomposition into parts.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

struct Hull {
  Mesh mesh;                  ///< closed, facing outwards; its vertices are input points in their order, bit for bit
  std::vector<Plane> planes;  ///< one per facet, coplanar triangles merged; no input point lies outside any of them
  std::vector<std::uint32_t> plane_of_triangle;
};

/// The hull of `points` (metres); nullopt if they are flat: fewer than four, or within rounding of a plane. Inner
/// points, and points that stick out only by rounding, are not vertices. The same points give the same bytes. Throws
/// failure() if a coordinate is not finite.
std::optional<Hull> convex_hull(std::span<const Vec3> points);

}  // namespace palpa::geometry
