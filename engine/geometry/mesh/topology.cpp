#include "geometry/mesh/topology.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>

namespace palpa::geometry {

std::vector<Side> sorted_sides(const Mesh& mesh) {
  // Bucketing by the lower vertex first leaves only a handful of sides per bucket to sort: linear in practice.
  std::vector<std::uint32_t> start(mesh.positions.size() + 1, 0);
  const auto each_side = [&](const auto& visit) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        const std::uint32_t from = mesh.triangles[t][corner], to = mesh.triangles[t][(corner + 1) % 3];
        visit(Side{std::min(from, to), std::max(from, to),
                   static_cast<std::uint32_t>(3 * t) + static_cast<std::uint32_t>(corner), from < to});
      }
    }
  };
  each_side([&](const Side& s) { ++start[s.low + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<Side> sides(mesh.triangles.size() * 3);
  std::vector<std::uint32_t> next(start.begin(), start.end());
  each_side([&](const Side& s) { sides[next[s.low]++] = s; });
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    std::sort(sides.begin() + start[v], sides.begin() + start[v + 1],
              [](const Side& a, const Side& b) { return a.high != b.high ? a.high < b.high : a.side < b.side; });
  }
  return sides;
}

std::vector<std::uint32_t> twins(const Mesh& mesh) {
  const std::vector<Side> sides = sorted_sides(mesh);
  std::vector<std::uint32_t> twin(sides.size());
  for (std::size_t i = 0; i + 1 < sides.size(); i += 2) {
    twin[sides[i].side] = sides[i + 1].side;
    twin[sides[i + 1].side] = sides[i].side;
  }
  return twin;
}

std::uint32_t count_shells(const std::vector<std::uint32_t>& twin) {
  const auto triangles = static_cast<std::uint32_t>(twin.size() / 3);
  UnionFind shells(triangles);
  for (std::uint32_t side = 0; side < twin.size(); ++side)
    shells.join(side / 3, twin[side] / 3);
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < triangles; ++t)
    count += shells.find(t) == t ? 1 : 0;
  return count;
}

Vec3 area_vector(const Mesh& mesh, std::uint32_t triangle) {
  const glm::uvec3& t = mesh.triangles[triangle];
  const Vec3& a = mesh.positions[t[0]];
  return glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
}

double triangle_width(const Mesh& mesh, std::uint32_t triangle, double twice_area) {
  const glm::uvec3& t = mesh.triangles[triangle];
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    longest = std::max(longest, glm::distance(mesh.positions[t[i]], mesh.positions[t[(i + 1) % 3]]));
  }
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
