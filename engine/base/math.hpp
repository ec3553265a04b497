// Vectors and transforms on the host. Everything that touches a file or a pose is in double precision; the GPU gets
// floats.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace palpa {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;

/// A rigid or affine map named T_a_b, which takes coordinates in frame b to frame a. GLM stores columns; files write
/// rows.
using Transform = glm::dmat4;

inline Vec3 transform_point(const Transform& T_a_b, const Vec3& point_b) {
  return Vec3(T_a_b * Vec4(point_b, 1.0));
}
inline Vec3 transform_direction(const Transform& T_a_b, const Vec3& direction_b) {
  return Vec3(T_a_b * Vec4(direction_b, 0.0));
}

inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Axis-aligned box; empty when any low > high.
struct Box {
  Vec3 low{1e300, 1e300, 1e300};
  Vec3 high{-1e300, -1e300, -1e300};

  bool empty() const { return low.x > high.x || low.y > high.y || low.z > high.z; }
  void add(const Vec3& p) {
    low = Vec3(p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z);
    high = Vec3(p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y, p.z > high.z ? p.z : high.z);
  }
  /// Whether the point lies in the box or on its surface.
  bool contains(const Vec3& p) const {
    return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
  }
  /// Whether the boxes have a point in common, or are at most `slack` apart along each axis.
  bool overlaps(const Box& other, double slack = 0) const {
    return low.x <= other.high.x + slack && other.low.x <= high.x + slack && low.y <= other.high.y + slack &&
           other.low.y <= high.y + slack && low.z <= other.high.z + slack && other.low.z <= high.z + slack;
  }
  /// The largest distance of a point from the origin along an axis.
  double reach() const {
    double farthest = 0;
    for (int i = 0; i < 3; ++i)
      farthest = std::max({farthest, std::abs(low[i]), std::abs(high[i])});
    return farthest;
  }
  Vec3 centre() const { return (low + high) * 0.5; }
  /// Bits 0 to 2 of a corner's number tell where it is at `high`: on x, y, z.
  std::array<Vec3, 8> corners() const {
    std::array<Vec3, 8> all;
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    return all;
  }
};

}  // namespace palpa
