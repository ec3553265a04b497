#include "geometry/shells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "geometry/predicates.hpp"
#include "geometry/topology.hpp"

namespace palpa::geometry {
namespace {

/// Does the segment pass through the triangle's inside? Empty where it only touches or lies in its plane.
std::optional<bool> passes(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int above = orient3d(a, b, c, p), below = orient3d(a, b, c, q);
  if (above * below > 0) return false;
  const int ab = orient3d(p, q, a, b), bc = orient3d(p, q, b, c), ca = orient3d(p, q, c, a);
  if (ab * bc < 0 || bc * ca < 0 || ca * ab < 0) return false;
  if (above * below == 0 || ab * bc * ca == 0) return std::nullopt;
  return true;
}

bool crosses(const Box& box, const Vec3& from, const Vec3& along) {
  double enter = 0, leave = 1;
  for (int i = 0; i < 3; ++i) {
    // Grown by what rounding can do to the quotients.
    const double slack = 1e-9 * (1 + std::abs(along[i]));
    double a = (box.low[i] - slack - from[i]) / along[i], b = (box.high[i] + slack - from[i]) / along[i];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter <= leave;
}

/// The shells that a ray from `from` leaves; false where it grazes one.
bool cast(const Mesh& mesh, const Bvh& bvh, const Shells& shells, std::uint32_t self, const Vec3& from,
          const Vec3& along, std::vector<std::uint32_t>& around) {
  around.clear();
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Bvh::Node& node = bvh.nodes()[index];
    if (!crosses(node.box, from, along)) continue;
    if (node.second != 0) {
      stack[depth++] = node.second;
      stack[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t t = bvh.order()[i], shell = shells.of_triangle[t];
      if (shell == self) continue;
      const glm::uvec3& v = mesh.triangles[t];
      const auto through = passes(from, from + along, mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]);
      if (!through) return false;
      if (!*through) continue;
      const auto place = std::find(around.begin(), around.end(), shell);
      if (place != around.end()) {
        around.erase(place);
      } else {
        around.push_back(shell);
      }
    }
  }
  std::sort(around.begin(), around.end());
  return true;
}

}  // namespace

Shells find_shells(const Mesh& mesh, std::span<const std::uint32_t> twin) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  UnionFind groups(count);
  for (std::uint32_t side = 0; side < twin.size(); ++side)
    groups.join(side / 3, twin[side] / 3);
  Shells shells;
  shells.of_triangle.resize(count);
  for (std::uint32_t t = 0; t < count; ++t) {
    const std::uint32_t first = groups.find(t);
    if (first == t) {
      shells.of_triangle[t] = static_cast<std::uint32_t>(shells.list.size());
      shells.list.push_back({t, 0, 0, {}});
    } else {
      shells.of_triangle[t] = shells.of_triangle[first];
    }
    Shell& shell = shells.list[shells.of_triangle[t]];
    const glm::uvec3& v = mesh.triangles[t];
    const Vec3& origin = mesh.positions[mesh.triangles[shell.first][0]];
    shell.volume += glm::dot(mesh.positions[v[0]] - origin, area_vector(mesh, t)) / 6;
    shell.area += glm::length(area_vector(mesh, t)) / 2;
  }
  return shells;
}

void find_nesting(const Mesh& mesh, const Bvh& bvh, Shells& shells) {
  const Box& all = bvh.nodes()[0].box;
  const double reach = 4 * glm::distance(all.low, all.high);
  for (std::uint32_t s = 0; s < shells.list.size(); ++s) {
    const Vec3& from = mesh.positions[mesh.triangles[shells.list[s].first][0]];
    // A ray that grazes an edge says nothing; directions without a pattern, until one does not.
    std::uint32_t seed = 12'345;
    const auto next = [&seed] {
      seed = seed * 1'664'525U + 1'013'904'223U;
      return (seed >> 8U) / 16'777'216.0 - 0.5;
    };
    for (int attempt = 0; attempt < 64; ++attempt) {
      Vec3 along(0);
      for (int i = 0; i < 3; ++i)
        along[i] = next() + (i == attempt % 3 ? 1.0 : 0.0);
      if (cast(mesh, bvh, shells, s, from, along * reach, shells.list[s].around)) break;
    }
  }
}

void flip(Mesh& mesh, const Shells& shells, const std::vector<char>& marked) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (marked[shells.of_triangle[t]] != 0) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
}

}  // namespace palpa::geometry
