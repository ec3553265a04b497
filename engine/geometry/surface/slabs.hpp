// The slab in which all triangles below a node of a tree of boxes lie, across their mean normal. Seen from afar a
// smooth piece of surface is hardly thicker than its slab, where its box is as thick as it is wide: what asks for the
// nearest triangle looks at a fraction of the nodes.
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

/// One for each node, relative to the centre that `triangles`, in the tree's order, are relative to; `spare` metres
/// wider than they are, for rounding.
std::vector<Slab> make_slabs(std::span<const Bvh::Node> nodes, std::span<const shader::SurfaceTriangle> triangles,
                             double spare);

/// Of a point from a slab; 0 inside.
inline float distance(const Slab& slab, const glm::vec3& p) {
  const float at = slab.normal.x * p.x + slab.normal.y * p.y + slab.normal.z * p.z;
  const float below = slab.low - at, above = at - slab.high;
  const float out = below > above ? below : above;
  return out > 0 ? out : 0;
}

}  // namespace palpa::geometry
