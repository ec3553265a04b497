#include "assets/generators/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

namespace palpa::assets {
namespace {

using geometry::Mesh;

std::uint32_t at(Ring ring, std::uint32_t step) {
  return ring.first + step % ring.count;
}

/// One side of an edge, lower vertex first in `ends`.
struct Side {
  std::array<std::uint32_t, 2> ends;
  std::uint32_t triangle;
  int corner;  ///< of the triangle, opposite the edge
};

std::vector<Side> sorted_sides(const Mesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto [low, high] = std::minmax({mesh.triangles[t][(corner + 1) % 3], mesh.triangles[t][(corner + 2) % 3]});
      sides.push_back({{low, high}, t, corner});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const Side& p, const Side& q) { return p.ends != q.ends ? p.ends < q.ends : p.triangle < q.triangle; });
  return sides;
}

bool has_edge(const std::vector<Side>& sides, std::uint32_t p, std::uint32_t q) {
  const std::array<std::uint32_t, 2> ends{std::min(p, q), std::max(p, q)};
  const auto found = std::lower_bound(sides.begin(), sides.end(), ends,
                                      [](const Side& s, const std::array<std::uint32_t, 2>& e) { return s.ends < e; });
  return found != sides.end() && found->ends == ends;
}

/// One pass; a triangle takes part in one flip at most, so that `sides` stays true for the others.
bool flip_pass(Mesh& mesh, const std::function<bool(const Hinge&)>& worse) {
  const std::vector<Side> sides = sorted_sides(mesh);
  std::vector<char> touched(mesh.triangles.size(), 0);
  bool flipped = false;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &s = sides[i], &o = sides[i + 1];
    if (s.ends != o.ends || touched[s.triangle] != 0 || touched[o.triangle] != 0) continue;
    const std::uint32_t left = mesh.triangles[s.triangle][s.corner];
    const std::uint32_t a = mesh.triangles[s.triangle][(s.corner + 1) % 3];
    const std::uint32_t b = mesh.triangles[s.triangle][(s.corner + 2) % 3];
    const std::uint32_t right = mesh.triangles[o.triangle][o.corner];
    const auto& p = mesh.positions;
    if (!worse({p[a], p[b], p[left], p[right]}) || has_edge(sides, left, right)) continue;
    mesh.triangles[s.triangle] = {a, right, left};
    mesh.triangles[o.triangle] = {right, b, left};
    touched[s.triangle] = touched[o.triangle] = 1;
    flipped = true;
  }
  return flipped;
}

}  // namespace

void sew(Mesh& mesh, Ring a, Ring b) {
  const auto distance = [&](std::uint32_t p, std::uint32_t q) {
    return glm::distance(mesh.positions[p], mesh.positions[q]);
  };
  // Begin where b is nearest to a's first vertex.
  std::uint32_t start = 0;
  for (std::uint32_t j = 1; j < b.count; ++j) {
    if (distance(at(b, j), a.first) < distance(at(b, start), a.first)) start = j;
  }
  const std::uint32_t steps_a = a.count > 1 ? a.count : 0, steps_b = b.count > 1 ? b.count : 0;
  for (std::uint32_t i = 0, j = 0; i < steps_a || j < steps_b;) {
    const std::uint32_t from_a = at(a, i), from_b = at(b, start + j);
    const std::uint32_t to_a = at(a, i + 1), to_b = at(b, start + j + 1);
    if (j == steps_b || (i < steps_a && distance(to_a, from_b) < distance(from_a, to_b))) {
      mesh.triangles.emplace_back(from_a, from_b, to_a);
      ++i;
    } else {
      mesh.triangles.emplace_back(from_a, from_b, to_b);
      ++j;
    }
  }
}

void flip_edges(Mesh& mesh, const std::function<bool(const Hinge&)>& worse, int passes) {
  for (int pass = 0; pass < passes && flip_pass(mesh, worse); ++pass) {
  }
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
