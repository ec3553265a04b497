#include "geometry/mesh/topology.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

namespace palpa::geometry {

std::vector<Side> sorted_sides(std::size_t vertices, std::span<const glm::uvec3> triangles) {
  // Bucketing by the lower vertex first leaves only a handful of sides per bucket to sort: linear in practice.
  std::vector<std::uint32_t> start(vertices + 1, 0);
  const auto each_side = [&](const auto& visit) {
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t from = triangles[t][corner], to = triangles[t][(corner + 1) % 3];
        visit(Side{std::min(from, to), std::max(from, to),
                   static_cast<std::uint32_t>(3 * t) + static_cast<std::uint32_t>(corner), from < to});
      }
    }
  };
  each_side([&](const Side& s) { ++start[s.low + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Side> sides(triangles.size() * 3);
  std::vector<std::uint32_t> next(start.begin(), start.end());
  each_side([&](const Side& s) { sides[next[s.low]++] = s; });
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    std::sort(sides.begin() + start[v], sides.begin() + start[v + 1],
              [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.side < b.side; });
  }
  return sides;
}

std::vector<std::uint32_t> twins(const Mesh& mesh) {
  const std::vector<Side> sides = sorted_sides(mesh.positions.size(), mesh.triangles);
  std::vector<std::uint32_t> twin(sides.size());
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
    twin[sides[i].side] = sides[i + 1].side;
    twin[sides[i + 1].side] = sides[i].side;
  }
  return twin;
}

Vec3 area_vector(const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const Vec3& a = mesh.positions[t[0]];
  return glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

Vec3 unit_normal(const Mesh& mesh, std::uint32_t triangle) {
  const Vec3 across = area_vector(mesh, triangle);
  const double length = glm::length(across);
  return length > 0 ? across / length : Vec3(0);
}

std::vector<Vec3> unit_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t)
    normals[t] = unit_normal(mesh, t);
  return normals;
}

double longest_side(const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  double longest = 0;
  for (int i = 0; i < 3; ++i)
    longest = std::max(longest, glm::distance(mesh.positions[t[i]], mesh.positions[t[(i + 1) % 3]]));
  return longest;
}

double triangle_width(const Mesh& mesh, std::uint32_t triangle) {
  return triangle_width(mesh, triangle, glm::length(area_vector(mesh, triangle)));
}

double triangle_width(const Mesh& mesh, std::uint32_t triangle, double twice_area) {
  const double longest = longest_side(mesh, triangle);
  return longest > 0 ? twice_area / longest : 0;
}

UnionFind::UnionFind(std::size_t count) : parent_(count) {
  std::iota(parent_.begin(), parent_.end(), 0U);
}

std::uint32_t UnionFind::find(std::uint32_t item) {
  while (parent_[item] != item) {
    parent_[item] = parent_[parent_[item]];
    item = parent_[item];
  }
  return item;
}

void UnionFind::join(std::uint32_t a, std::uint32_t b) {
  a = find(a);
  b = find(b);
  if (a < b) {
    parent_[b] = a;
  } else {
    parent_[a] = b;
  }
}

}  // namespace palpa::geometry
