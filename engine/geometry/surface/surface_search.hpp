// Queries of the tree of boxes for the cells of a surface's grid: the nearest triangle, and all that may be nearest.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/surface/slabs.hpp"
#include "geometry/surface/surface_contest.hpp"
#include "geometry/surface/surface_triangles.hpp"

namespace palpa::geometry {

class SurfaceSearch {
 public:
  /// The arguments must outlive it. `triangles` are in the tree's order and relative to `centre`, as are all points
  /// here. `epsilon` is the distance in metres by which rounding may move a point.
  SurfaceSearch(const Bvh& bvh, const SurfaceTriangles& triangles, const Vec3& centre, double epsilon);

  /// The triangle nearest to p (the first if several are equally near) and its distance. `guess` is a triangle that may
  /// be near. Adds the number of visited nodes to `steps`.
  std::uint32_t nearest(const glm::vec3& p, std::uint32_t guess, float& distance2, std::uint64_t& steps) const;

  /// Appends, in ascending order, the triangles that no rival beats in the cell with these corners. A visited node
  /// counts once per corner.
  void gather(const Contest& contest, const Corners& corners, std::vector<std::uint32_t>& list,
              std::uint64_t& steps) const;

 private:
  const Bvh& bvh_;
  const SurfaceTriangles& t_;
  Vec3 centre_;
  double epsilon_;
  std::vector<Slab> slabs_;
};

}  // namespace palpa::geometry
