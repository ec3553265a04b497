#include "geometry/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>

namespace palpa::geometry {
namespace {

constexpr std::uint32_t leaf_size = 4;

double square(const Vec3& v) {
  return glm::dot(v, v);
}

/// Square of the distance from a point to a box.
double box_distance(const Box& box, const Vec3& p) {
  return square(glm::max(glm::max(box.low - p, p - box.high), Vec3(0)));
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
    // Inside all three sides: straight above the triangle.
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

NearestTriangle::NearestTriangle(const Mesh& mesh) : mesh_(&mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  std::vector<Vec3> centres;
  centres.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles)
    centres.push_back((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()), centres);
}

void NearestTriangle::build(std::uint32_t begin, std::uint32_t end, std::vector<Vec3>& centres) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, begin, end});
  Box box, middle_box;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (int corner = 0; corner < 3; ++corner)
      box.add(mesh_->positions[mesh_->triangles[order_[i]][corner]]);
    middle_box.add(centres[order_[i]]);
  }
  nodes_[self].box = box;
  if (end - begin <= leaf_size) return;
  const Vec3 extent = middle_box.high - middle_box.low;
  const int axis = extent.x >= extent.y ? (extent.x >= extent.z ? 0 : 2) : (extent.y >= extent.z ? 1 : 2);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return centres[a][axis] < centres[b][axis]; });
  build(begin, middle, centres);
  nodes_[self].second = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, centres);
}

double NearestTriangle::distance(const Vec3& point) const {
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::pair<double, std::uint32_t>> stack;
  if (!nodes_.empty()) stack.emplace_back(box_distance(nodes_[0].box, point), 0U);
  while (!stack.empty()) {
    const auto [far, n] = stack.back();
    stack.pop_back();
    if (far >= best) continue;
    const Node& node = nodes_[n];
    if (node.second == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) {
        const glm::uvec3& t = mesh_->triangles[order_[i]];
        best = std::min(best, square(closest_on_triangle(mesh_->positions[t[0]], mesh_->positions[t[1]],
                                                         mesh_->positions[t[2]], point) -
                                     point));
      }
      continue;
    }
    std::pair<double, std::uint32_t> near{box_distance(nodes_[n + 1].box, point), n + 1};
    std::pair<double, std::uint32_t> other{box_distance(nodes_[node.second].box, point), node.second};
    if (other.first < near.first) std::swap(near, other);
    stack.push_back(other);
    stack.push_back(near);
  }
  return std::sqrt(best);
}

}  // namespace palpa::geometry
