#include "geometry/surface/slabs.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "base/system/parallel.hpp"

namespace palpa::geometry {
namespace {

struct TriangleCorners {
  Vec3 a, b, c;
};

TriangleCorners corners_of(const shader::SurfaceTriangle& t) {
  const Vec3 a(t.corner.x, t.corner.y, t.corner.z), x(t.along.x, t.along.y, t.along.z);
  const Vec3 y = glm::cross(Vec3(t.normal.x, t.normal.y, t.normal.z), x);
  const double third = t.rest.w;
  return {a, a + x * static_cast<double>(t.corner.w), a - third * (x * double{t.rest.y} + y * double{t.rest.z})};
}

}  // namespace

std::vector<Slab> make_slabs(std::span<const Bvh::Node> nodes, std::span<const shader::SurfaceTriangle> triangles,
                             double spare) {
  // For each triangle, the sum of area times normal of all triangles before it.
  std::vector<Vec3> before{Vec3(0)};
  before.reserve(triangles.size() + 1);
  for (const shader::SurfaceTriangle& t : triangles) {
    const TriangleCorners corners = corners_of(t);
    before.push_back(before.back() + glm::cross(corners.b - corners.a, corners.c - corners.a));
  }
  std::vector<Slab> slabs(nodes.size());
  constexpr std::size_t chunk = 64;
  parallel_chunks(nodes.size(), chunk, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 sum = before[nodes[i].end] - before[nodes[i].begin];
      const double length = glm::length(sum);
      const glm::vec3 normal = length > 0 ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
      double low = std::numeric_limits<double>::max(), high = -low;
      for (std::uint32_t t = nodes[i].begin; t < nodes[i].end; ++t) {
        const TriangleCorners corners = corners_of(triangles[t]);
        for (const Vec3& corner : {corners.a, corners.b, corners.c}) {
          const double at = glm::dot(Vec3(normal), corner);
          low = std::min(low, at);
          high = std::max(high, at);
        }
      }
      slabs[i] = {normal, static_cast<float>(low - spare), static_cast<float>(high + spare)};
    }
  });
  return slabs;
}

}  // namespace palpa::geometry
