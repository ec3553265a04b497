#include "support/mesh_oracle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

namespace palpa::test {
namespace {

constexpr std::uint32_t leaf_triangles = 4;
using Stack = std::array<std::uint32_t, 128>;

double squared(const Vec3& v) {
  return glm::dot(v, v);
}

/// Squared distance to the segment ab.
double to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = squared(along);
  const double t = length > 0 ? std::clamp(glm::dot(p - a, along) / length, 0.0, 1.0) : 0.0;
  return squared(a + t * along - p);
}

/// Squared distance to the triangle: to its plane if the foot lies inside, else to its edges.
double to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = glm::cross(b - a, c - a);
  const bool above = glm::dot(glm::cross(b - a, p - a), normal) >= 0 &&
                     glm::dot(glm::cross(c - b, p - b), normal) >= 0 && glm::dot(glm::cross(a - c, p - c), normal) >= 0;
  if (above && squared(normal) > 0) {
    const double height = glm::dot(p - a, normal);
    return height * height / squared(normal);
  }
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

/// The solid angle of a triangle (van Oosterom and Strackee 1983).
double solid_angle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = a - p, v = b - p, w = c - p;
  const double lu = glm::length(u), lv = glm::length(v), lw = glm::length(w);
  return 2 * std::atan2(glm::dot(u, glm::cross(v, w)),
                        lu * lv * lw + glm::dot(u, v) * lw + glm::dot(v, w) * lu + glm::dot(w, u) * lv);
}

double to_box(const Vec3& p, const Vec3& low, const Vec3& high) {
  return squared(glm::clamp(p, low, high) - p);
}

}  // namespace

MeshOracle::MeshOracle(const geometry::Mesh& mesh) {
  for (const glm::uvec3& t : mesh.triangles)
    triangles_.push_back({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]});
  nodes_.emplace_back();
  build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void MeshOracle::build(std::uint32_t index, std::uint32_t first, std::uint32_t count) {
  Node node{Vec3(1e300), Vec3(-1e300), Vec3(0), Vec3(0)};
  double whole = 0;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[i];
    node.low = glm::min(node.low, glm::min(t.a, glm::min(t.b, t.c)));
    node.high = glm::max(node.high, glm::max(t.a, glm::max(t.b, t.c)));
    const Vec3 area = 0.5 * glm::cross(t.b - t.a, t.c - t.a);
    const double size = glm::length(area);
    node.area += area;
    node.centre += size / 3 * (t.a + t.b + t.c);
    whole += size;
  }
  node.centre = whole > 0 ? node.centre / whole : node.low;
  for (std::uint32_t i = first; i < first + count; ++i) {
    for (const Vec3& corner : {triangles_[i].a, triangles_[i].b, triangles_[i].c})
      node.radius = std::max(node.radius, glm::distance(corner, node.centre));
  }
  if (count <= leaf_triangles) {
    node.first = first;
    node.count = count;
    nodes_[index] = node;
    return;
  }
  const Vec3 size = node.high - node.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto begin = triangles_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count, [axis](const Triangle& s, const Triangle& t) {
    return s.a[axis] + s.b[axis] + s.c[axis] < t.a[axis] + t.b[axis] + t.c[axis];
  });
  node.first = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[index] = node;
  build(node.first, first, count / 2);
  build(node.first + 1, first + count / 2, count - count / 2);
}

double MeshOracle::distance(const Vec3& point, double most) const {
  double least = most * most;
  Stack stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (to_box(point, node.low, node.high) >= least) continue;
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      least = std::min(least, to_triangle(point, triangles_[i].a, triangles_[i].b, triangles_[i].c));
    if (node.count > 0) continue;
    std::uint32_t near = node.first, far = node.first + 1;
    if (to_box(point, nodes_[far].low, nodes_[far].high) < to_box(point, nodes_[near].low, nodes_[near].high))
      std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return std::sqrt(least);
}

double MeshOracle::winding(const Vec3& point, double far) const {
  double angle = 0;
  Stack stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    const Vec3 to = node.centre - point;
    const double distance = glm::length(to);
    if (distance > far * node.radius) {
      angle += glm::dot(node.area, to) / (distance * distance * distance);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      angle += solid_angle(point, triangles_[i].a, triangles_[i].b, triangles_[i].c);
    if (node.count > 0) continue;
    stack[depth++] = node.first;
    stack[depth++] = node.first + 1;
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace palpa::test
