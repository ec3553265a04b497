#include "geometry/mesh/shells.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>

#include "base/system/parallel.hpp"
#include "geometry/mesh/predicates.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::geometry {
namespace {

/// Whether the segment passes through the triangle's inside. Empty if it only touches the triangle or lies in its
/// plane.
std::optional<bool> passes(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const int above = orient3d(a, b, c, p), below = orient3d(a, b, c, q);
  if (above * below > 0) return false;
  const int ab = orient3d(p, q, a, b), bc = orient3d(p, q, b, c), ca = orient3d(p, q, c, a);
  if (ab * bc < 0 || bc * ca < 0 || ca * ab < 0) return false;
  if (above * below == 0 || ab * bc * ca == 0) return std::nullopt;
  return true;
}

/// Whether the ray's part before `end` crosses the box.
bool crosses(const Box& box, const Vec3& from, const Vec3& along, double end) {
  double enter = 0, leave = std::min(end, 1.0);
  for (int i = 0; i < 3; ++i) {
    // Enlarged by the possible rounding error of the quotients.
    const double slack = 1e-9 * (1 + std::abs(along[i]));
    double a = (box.low[i] - slack - from[i]) / along[i], b = (box.high[i] + slack - from[i]) / along[i];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter <= leave;
}

/// Where the ray from `from` first meets another shell than `self`.
struct Meeting {
  double at = 2;    ///< as a fraction of the ray's length; above 1 if it meets none
  double next = 2;  ///< the same for the second time
  std::uint32_t shell = 0;
  bool inside = false;  ///< the ray begins inside that shell
};

/// nullopt if the ray grazes a triangle nearer than the shell that it meets.
std::optional<Meeting> cast(const Mesh& mesh, const Bvh& bvh, const Shells& shells, std::uint32_t self,
                            const Vec3& from, const Vec3& along) {
  Meeting met;
  double grazed = 2;
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Bvh::Node& node = bvh.nodes()[index];
    if (!crosses(node.box, from, along, met.next)) continue;
    if (node.second != 0) {
      // Visits the nearer half first, because its contents may rule out the other.
      const auto ahead = [&](std::uint32_t child) { return glm::dot(bvh.nodes()[child].box.centre(), along); };
      const bool first_nearer = ahead(index + 1) <= ahead(node.second);
      stack[depth++] = first_nearer ? node.second : index + 1;
      stack[depth++] = first_nearer ? index + 1 : node.second;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::uint32_t t = bvh.order()[i];
      if (shells.of_triangle[t] == self) continue;
      const glm::uvec3& v = mesh.triangles[t];
      const Vec3 &a = mesh.positions[v[0]], &b = mesh.positions[v[1]], &c = mesh.positions[v[2]];
      const auto through = passes(from, from + along, a, b, c);
      if (through && !*through) continue;
      const Vec3 normal = glm::cross(b - a, c - a);
      const double slope = glm::dot(normal, along);
      const double at = slope != 0 ? glm::dot(normal, a - from) / slope : 0;
      if (!through) {
        grazed = std::min(grazed, at);
      } else if (at < met.at) {
        met.next = met.at;
        met.at = at;
        met.shell = shells.of_triangle[t];
        // Below the triangle is inside, except for a shell that faces inwards.
        met.inside = (orient3d(a, b, c, from) < 0) == (shells.list[met.shell].volume > 0);
      } else {
        met.next = std::min(met.next, at);
      }
    }
  }
  // Two crossings that rounding may have put in the wrong order are inconclusive, unless one shell is met twice.
  constexpr double rounding = 1e-9;
  if ((grazed <= 1 && grazed <= met.at + rounding) || (met.at <= 1 && met.next - met.at <= rounding))
    return std::nullopt;
  return met;
}

/// Each shell's vertex that lies farthest along the direction.
std::vector<Vec3> farthest(const Mesh& mesh, const Shells& shells, const Vec3& along) {
  std::vector<Vec3> best;
  best.reserve(shells.list.size());
  for (const Shell& shell : shells.list)
    best.push_back(mesh.positions[mesh.triangles[shell.first][0]]);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3& farthest = best[shells.of_triangle[t]];
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.positions[mesh.triangles[t][i]];
      if (glm::dot(p, along) > glm::dot(farthest, along)) farthest = p;
    }
  }
  return best;
}

/// A pseudo-random direction, always the same for the same attempt.
Vec3 direction(int attempt) {
  std::uint32_t seed = 12'345 + static_cast<std::uint32_t>(attempt) * 7919;
  const auto next = [&seed] {
    seed = seed * 1'664'525U + 1'013'904'223U;
    return (seed >> 8U) / 16'777'216.0 - 0.5;
  };
  Vec3 along(0);
  for (int i = 0; i < 3; ++i)
    along[i] = next() + (i == attempt % 3 ? 1.0 : 0.0);
  return along;
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
      shells.list.push_back({.first = t});
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
  const auto count = static_cast<std::uint32_t>(shells.list.size());
  for (std::uint32_t s = 0; s < count; ++s)
    shells.list[s].parent = shells.list[s].outermost = s;
  const Box& all = bvh.nodes()[0].box;
  const double reach = 4 * glm::distance(all.low, all.high);
  for (int attempt = 0; attempt < 64; ++attempt) {
    // One direction for all: a shell that another one meets then lies farther along it, which gives an order.
    const Vec3 along = direction(attempt) * reach;
    const std::vector<Vec3> from = farthest(mesh, shells, along);
    std::vector<Meeting> met(count);
    std::atomic<bool> grazed{false};
    parallel_chunks(count, 64, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (auto s = static_cast<std::uint32_t>(begin); s < end && !grazed; ++s) {
        const auto found = cast(mesh, bvh, shells, s, from[s], along);
        if (!found) grazed = true;
        if (found) met[s] = *found;
      }
    });
    if (grazed) continue;
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return glm::dot(from[a], along) > glm::dot(from[b], along); });
    for (const std::uint32_t s : order) {
      if (met[s].at > 1) continue;
      const Shell& other = shells.list[met[s].shell];
      // A shell that meets another from outside has the same parent as that shell, or none if it has none.
      if (!met[s].inside && other.depth == 0) continue;
      Shell& shell = shells.list[s];
      shell.parent = met[s].inside ? met[s].shell : other.parent;
      shell.depth = shells.list[shell.parent].depth + 1;
      shell.outermost = shells.list[shell.parent].outermost;
    }
    return;
  }
}

void flip(Mesh& mesh, const Shells& shells, const std::vector<char>& marked) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (marked[shells.of_triangle[t]] != 0) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
}

}  // namespace palpa::geometry
