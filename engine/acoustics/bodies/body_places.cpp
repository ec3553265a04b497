#include "acoustics/bodies/body_places.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <optional>

#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

/// Margins in addition to the gap between patch and face: for the rounding of files and single precision, in sides, and
/// for the slope of the patch, in gaps.
constexpr double sides_beside = 1e-3, gaps_beside = 0.05;

/// u and v of a point of the triangle.
Vec2 coordinates(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& point) {
  const Vec3 normal = glm::cross(b - a, c - a), from = point - a;
  const double area2 = glm::dot(normal, normal);
  const Vec2 uv(glm::dot(glm::cross(from, c - a), normal) / area2, glm::dot(glm::cross(b - a, from), normal) / area2);
  return {std::clamp(uv.x, 0.0, 1.0), std::clamp(uv.y, 0.0, 1 - std::clamp(uv.x, 0.0, 1.0))};
}

}  // namespace

BodyPlaces::BodyPlaces(const Patches& body) : body_(body), nearest_(body.mesh), inside_(body.mesh) {}

BodyPlace BodyPlaces::of(const Vec3& point) const {
  const geometry::NearestTriangle::Found found = nearest_.find(point).value();
  const glm::uvec3& t = body_.mesh.triangles[found.triangle];
  const Vec3 &a = body_.mesh.positions[t.x], &b = body_.mesh.positions[t.y], &c = body_.mesh.positions[t.z];
  const Vec2 uv = coordinates(a, b, c, found.point);
  BodyPlace place{.face = found.triangle, .u = uv.x, .v = uv.y, .distance_m = found.distance};
  // The gap lies on one side of the face.
  const Vec3 to_patch = body_.patches[found.triangle].at(uv.x, uv.y) - found.point;
  const double gap = glm::dot(to_patch, point - found.point) > 0 ? glm::length(to_patch) : 0;
  const double side = longest_side(body_.mesh, found.triangle);
  if (found.distance <= (1 + gaps_beside) * gap + sides_beside * side) {
    place.where = BodyPlace::Where::skin;
  } else if (inside_.holds(point)) {
    place.where = BodyPlace::Where::inside;
  }
  return place;
}

}  // namespace palpa::acoustics
