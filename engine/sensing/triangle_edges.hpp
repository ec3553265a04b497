// Intersection of a triangle with a camera's rays.
#pragma once

#include <array>
#include <glm/geometric.hpp>

#include "base/math.hpp"

namespace palpa::sensing {

/// Edge functions of a triangle over ray directions (Olano and Greer, "Triangle Scan Conversion using 2D Homogeneous
/// Coordinates", 1997). They need no clipping and are exact under any lens. Neighbours share their edge's value up to
/// the sign, so a closed mesh has no cracks.
struct TriangleEdges {
  std::array<Vec3, 3> edge;
  double determinant = 0;
  double per_normal = 0;

  /// Corners in camera coordinates.
  TriangleEdges(const Vec3& a, const Vec3& b, const Vec3& c)
      : edge{glm::cross(b, c), glm::cross(c, a), glm::cross(a, b)} {
    determinant = glm::dot(a, edge[0]);
    const double length = glm::length(edge[0] + edge[1] + edge[2]);
    per_normal = length > 0 ? 1 / length : 0;
    if (determinant < 0) {  // seen from behind: same test with all signs flipped
      determinant = -determinant;
      for (Vec3& e : edge)
        e = -e;
    }
  }
  bool visible() const { return determinant > 0 && per_normal > 0; }
};

inline double along(const Vec3& edge, double x, double y) {
  return edge.x * x + edge.y * y + edge.z;
}

/// The hit of a ray: the triangle's depth along z, and the slant (DepthImage).
struct RayHit {
  double depth;
  float slant;
};
/// False if the ray (x, y, 1) misses the triangle or runs along it.
inline bool meets(const TriangleEdges& t, double x, double y, RayHit& hit) {
  const double a = along(t.edge[0], x, y), b = along(t.edge[1], x, y), c = along(t.edge[2], x, y);
  if (a < 0 || b < 0 || c < 0) return false;
  const double sum = a + b + c;
  // A ray within the triangle's own plane has a sum of 0. A pixel without a ray has a huge sum and no depth.
  hit = {t.determinant / sum, static_cast<float>(sum * t.per_normal)};
  return hit.depth > 1e-6;
}

}  // namespace palpa::sensing
