#include "geometry/surface/surface_depth.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

namespace palpa::geometry {
namespace {

double segment_distance2(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  const Vec3 apart = p - a - t * along;
  return glm::dot(apart, apart);
}

double triangle_distance2(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = glm::cross(b - a, c - a);
  const double area2 = glm::dot(normal, normal);
  const bool above = area2 > 0 && glm::dot(glm::cross(b - a, p - a), normal) >= 0 &&
                     glm::dot(glm::cross(c - b, p - b), normal) >= 0 && glm::dot(glm::cross(a - c, p - c), normal) >= 0;
  if (above) {
    const double height = glm::dot(p - a, normal);
    return height * height / area2;
  }
  return std::min({segment_distance2(p, a, b), segment_distance2(p, b, c), segment_distance2(p, c, a)});
}

double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
  const double volume = glm::dot(a, glm::cross(b, c));
  return 2 * std::atan2(volume, la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

}  // namespace

double surface_depth(const Mesh& mesh, const Vec3& point) {
  double nearest2 = std::numeric_limits<double>::infinity(), winding = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    nearest2 = std::min(nearest2, triangle_distance2(point, a, b, c));
    winding += solid_angle(a - point, b - point, c - point);
  }
  const double distance = std::sqrt(nearest2);
  return winding > 2 * std::numbers::pi ? distance : -distance;
}

}  // namespace palpa::geometry
