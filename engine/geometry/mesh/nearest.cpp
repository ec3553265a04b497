#include "geometry/mesh/nearest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

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

/// Whether the triangle's box is farther from p than the square root of `far2`.
bool is_beyond(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, double far2) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double low = std::min(std::min(a[i], b[i]), c[i]), high = std::max(std::max(a[i], b[i]), c[i]);
    const double out = std::max(std::max(low - p[i], p[i] - high), 0.0);
    sum += out * out;
  }
  return sum > far2;
}

}  // namespace

Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 normal = glm::cross(b - a, c - a);
  // Whether p is beyond an edge: the nearest point is on one of the edges that it is beyond.
  bool ab = true, bc = true, ca = true;
  if (const double twice = square(normal); twice > 0) {
    bc = glm::dot(glm::cross(c - b, p - b), normal) < 0;
    ca = glm::dot(glm::cross(a - c, p - c), normal) < 0;
    ab = glm::dot(glm::cross(b - a, p - a), normal) < 0;
    if (!ab && !bc && !ca) return p - normal * (glm::dot(p - a, normal) / twice);
  }
  Vec3 best = ab ? closest_on_segment(a, b, p) : bc ? closest_on_segment(b, c, p) : closest_on_segment(c, a, p);
  const auto try_edge = [&](const Vec3& from, const Vec3& to) {
    const Vec3 q = closest_on_segment(from, to, p);
    if (square(q - p) < square(best - p)) best = q;
  };
  if (ab && bc) try_edge(b, c);
  if (ca && (ab || bc)) try_edge(c, a);
  return best;
}

double NearestTriangle::distance(const Vec3& point, double most) const {
  const std::optional<Found> found = find(point, most);
  return found ? found->distance : most;
}

std::optional<NearestTriangle::Found> NearestTriangle::find(const Vec3& point, double most) const {
  constexpr double more_than_rounding = 1 + 1e-6;
  const auto nodes = tree_.nodes();
  double best = most * most;
  std::optional<Found> found;
  std::array<std::pair<double, std::uint32_t>, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {distance2(nodes[0].box, point), 0U};
  while (depth > 0) {
    const auto [far, n] = stack[--depth];
    if (far >= best) continue;
    const Bvh::Node& node = nodes[n];
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const std::uint32_t triangle = tree_.order()[i];
        const glm::uvec3& t = mesh_->triangles[triangle];
        const Vec3 &a = mesh_->positions[t[0]], &b = mesh_->positions[t[1]], &c = mesh_->positions[t[2]];
        if (is_beyond(a, b, c, point, more_than_rounding * best)) continue;
        const Vec3 at = closest_on_triangle(a, b, c, point);
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
    stack[depth++] = other;
    stack[depth++] = near;
  }
  if (found) found->distance = std::sqrt(best);
  return found;
}

}  // namespace palpa::geometry
