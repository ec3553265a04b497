#include "assets/generators/shape.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "geometry/mesh/topology.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

std::uint32_t at(Ring ring, std::uint32_t step) {
  return ring.first + step % ring.count;
}

}  // namespace

void sew(Mesh& mesh, Ring a, Ring b) {
  const auto distance = [&](std::uint32_t p, std::uint32_t q) {
    return glm::distance(mesh.positions[p], mesh.positions[q]);
  };
  // Begins where b is nearest to a's first vertex.
  std::uint32_t start = 0;
  for (std::uint32_t j = 1; j < b.count; ++j) {
    if (distance(at(b, j), a.first) < distance(at(b, start), a.first)) start = j;
  }
  const std::uint32_t steps_a = a.count > 1 ? a.count : 0, steps_b = b.count > 1 ? b.count : 0;
  for (std::uint32_t i = 0, j = 0; i < steps_a || j < steps_b;) {
    const std::uint32_t from_a = at(a, i), from_b = at(b, start + j);
    const std::uint32_t to_a = at(a, i + 1), to_b = at(b, start + j + 1);
    // Diagonals of a symmetric piece are equally long: the margin prevents that rounding decides.
    if (j == steps_b || (i < steps_a && distance(to_a, from_b) < (1.0 - 1e-9) * distance(from_a, to_b))) {
      mesh.triangles.emplace_back(from_a, from_b, to_a);
      ++i;
    } else {
      mesh.triangles.emplace_back(from_a, from_b, to_b);
      ++j;
    }
  }
}

Mesh largest_shell(const Mesh& mesh) {
  geometry::UnionFind pieces(mesh.positions.size());
  for (const glm::uvec3& t : mesh.triangles) {
    pieces.join(t.x, t.y);
    pieces.join(t.y, t.z);
  }
  std::vector<std::size_t> size(mesh.positions.size(), 0);
  for (const glm::uvec3& t : mesh.triangles)
    ++size[pieces.find(t.x)];
  const auto largest = static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  Mesh kept{mesh.positions, {}};
  for (const glm::uvec3& t : mesh.triangles) {
    if (pieces.find(t.x) == largest) kept.triangles.push_back(t);
  }
  return geometry::weld(kept);
}

void round_to_float(Mesh& mesh) {
  for (Vec3& p : mesh.positions)
    p = Vec3(glm::vec3(p)) + 0.0;  // + 0 makes negative zeros positive
}

double smallest_angle(const Mesh& mesh) {
  double smallest = 4.0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3& p = mesh.positions[t[corner]];
      const Vec3 u = mesh.positions[t[(corner + 1) % 3]] - p, v = mesh.positions[t[(corner + 2) % 3]] - p;
      smallest = std::min(smallest, std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)));
    }
  }
  return smallest;
}

}  // namespace palpa::assets
