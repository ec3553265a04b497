#include "crossings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <vector>

namespace palpa::assets {
namespace {

using Cell = std::array<int, 3>;

/// Six times the volume of the tetrahedron a b c d.
double volume6(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return glm::dot(glm::cross(b - a, c - a), d - a);
}

bool crosses(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  if ((volume6(a, b, c, p) > 0) == (volume6(a, b, c, q) > 0)) return false;
  const bool first = volume6(p, q, a, b) > 0;
  return first == (volume6(p, q, b, c) > 0) && first == (volume6(p, q, c, a) > 0);
}

Cell cell_of(const Vec3& p, double size) {
  return {static_cast<int>(std::floor(p.x / size)), static_cast<int>(std::floor(p.y / size)),
          static_cast<int>(std::floor(p.z / size))};
}

bool share_a_vertex(const glm::uvec3& s, const glm::uvec3& t) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (s[i] == t[j]) return true;
    }
  }
  return false;
}

}  // namespace

std::size_t count_crossings(const geometry::Mesh& mesh, double cell) {
  const auto& p = mesh.positions;
  std::map<Cell, std::vector<std::size_t>> grid;  // by first corner; the first corner of a crossing triangle is at most
                                                  // a cell away
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    grid[cell_of(p[mesh.triangles[t].x], cell)].push_back(t);
  std::size_t crossings = 0;
  for (const glm::uvec3& s : mesh.triangles) {
    const Cell home = cell_of(p[s.x], cell);
    // Two triangles smaller than a cell whose first corners are more than two cells apart cannot meet.
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z) {
          const auto found = grid.find({home[0] + x, home[1] + y, home[2] + z});
          if (found == grid.end()) continue;
          for (const std::size_t other : found->second) {
            const glm::uvec3& t = mesh.triangles[other];
            if (share_a_vertex(s, t)) continue;
            for (int c = 0; c < 3; ++c)
              crossings += crosses(p[s[c]], p[s[(c + 1) % 3]], p[t.x], p[t.y], p[t.z]) ? 1 : 0;
          }
        }
  }
  return crossings;
}

}  // namespace palpa::assets
