#include "geometry/mesh/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

namespace palpa::geometry {
namespace {

double square(const Vec3& v) {
  return glm::dot(v, v);
}

Vec3 closest_on_segment(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 along = b - a;
  const double length = square(along);
  return length > 0 ? a + along * std::clamp(glm::dot(p - a, along) / length, 0.0, 1.0) : a;
}

}  // namespace

Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 normal = glm::cross(b - a, c - a);
  if (const double twice = square(normal); twice > 0) {
    // On the inner side of all three edges: directly above the triangle.
    const double wa = glm::dot(glm::cross(c - b, p - b), normal), wb = glm::dot(glm::cross(a - c, p - c), normal),
                 wc = glm::dot(glm::cross(b - a, p - a), normal);
    if (wa >= 0 && wb >= 0 && wc >= 0) return p - normal * (glm::dot(p - a, normal) / twice);
  }
  Vec3 best = closest_on_segment(a, b, p);
  for (const Vec3& q : {closest_on_segment(b, c, p), closest_on_segment(c, a, p)}) {
    if (square(q - p) < square(best - p)) best = q;
  }
  return best;
}

double NearestTriangle::distance(const Vec3& point, double most) const {
  const std::optional<Found> found = find(point, most);
  return found ? found->distance : most;
}

std::optional<NearestTriangle::Found> NearestTriangle::find(const Vec3& point, double most) const {
  const auto nodes = tree_.nodes();
  double best = most * most;
  std::optional<Found> found;
  std::vector<std::pair<double, std::uint32_t>> stack{{distance2(nodes[0].box, point), 0U}};
  while (!stack.empty()) {
    const auto [far, n] = stack.back();
    stack.pop_back();
    if (far >= best) continue;
    const Bvh::Node& node = nodes[n];
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const std::uint32_t triangle = tree_.order()[i];
        const glm::uvec3& t = mesh_->triangles[triangle];
        const Vec3 at =
            closest_on_triangle(mesh_->positions[t[0]], mesh_->positions[t[1]], mesh_->positions[t[2]], point);
        if (const double away = square(at - point); away < best) {
          best = away;
          found = {triangle, at, 0};
        }
      }
      continue;
    }
    std::pair<double, std::uint32_t> near{distance2(nodes[n + 1].box, point), n + 1};
    std::pair<double, std::uint32_t> other{distance2(nodes[node.second].box, point), node.second};
    if (other.first < near.first) std::swap(near, other);
    stack.push_back(other);
    stack.push_back(near);
  }
  if (found) found->distance = std::sqrt(best);
  return found;
}

}  // namespace palpa::geometry
