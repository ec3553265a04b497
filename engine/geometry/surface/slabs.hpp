// Slabs for the nodes of a tree of boxes: the slab of a node contains all triangles below it, perpendicular to their
// mean normal. A smooth piece of surface is hardly thicker than its slab, whereas its box is as thick as it is wide. A
// search for the nearest triangle therefore visits only a fraction of the nodes.
#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/surface/surface_triangles.hpp"

namespace palpa::geometry {

struct Slab {
  glm::vec3 normal;  ///< unit
  float low, high;   ///< along the normal, metres
};

/// One slab for each node, relative to the same centre as `triangles`, which are in the tree's order. Each slab is
/// `spare` metres wider than its triangles, to allow for rounding.
std::vector<Slab> make_slabs(std::span<const Bvh::Node> nodes, std::span<const shader::SurfaceTriangle> triangles,
                             double spare);

/// Distance of a point from a slab; 0 inside.
inline float distance(const Slab& slab, const glm::vec3& p) {
  const float at = slab.normal.x * p.x + slab.normal.y * p.y + slab.normal.z * p.z;
  const float below = slab.low - at, above = at - slab.high;
  const float out = below > above ? below : above;
  return out > 0 ? out : 0;
}

}  // namespace palpa::geometry
