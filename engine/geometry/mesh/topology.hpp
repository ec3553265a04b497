// Adjacency tables of a mesh, the basis of closedness, shells and convexity.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Side `corner` (0..2) of triangle `triangle` goes from its corner to the next one. Sides are numbered 3 * triangle +
/// corner.
struct Side {
  std::uint32_t low, high;  ///< the edge's vertices in ascending order
  std::uint32_t side;       ///< 3 * triangle + corner
  bool ascending;           ///< the triangle traverses it from low to high
};

/// All sides, sorted by edge, then by number, so that the sides of one edge are adjacent.
std::vector<Side> sorted_sides(std::size_t vertices, std::span<const glm::uvec3> triangles);

/// For every side, the neighbouring triangle's side on the same edge. The mesh must be closed and oriented.
std::vector<std::uint32_t> twins(const Mesh& mesh);

/// Calls `visit` with all sides of each edge, edge after edge as sorted_sides() has them.
template <typename Visit>
void for_each_edge(std::size_t vertices, std::span<const glm::uvec3> triangles, const Visit& visit) {
  const std::vector<Side> sides = sorted_sides(vertices, triangles);
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high;)
      ++end;
    visit(std::span(sides).subspan(i, end - i));
  }
}
template <typename Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit) {
  for_each_edge(mesh.positions.size(), mesh.triangles, visit);
}

/// Start and end vertex of a side.
inline std::array<std::uint32_t, 2> side_vertices(const Mesh& mesh, std::uint32_t side) {
  const glm::uvec3& t = mesh.triangles[side / 3];
  const auto corner = static_cast<int>(side % 3);
  return {t[corner], t[(corner + 1) % 3]};
}

/// The triangle's corner that is not on the side.
inline std::uint32_t opposite_vertex(const Mesh& mesh, std::uint32_t side) {
  return mesh.triangles[side / 3][static_cast<int>((side + 2) % 3)];
}

/// Twice the triangle's area times its normal.
Vec3 area_vector(const Mesh& mesh, std::uint32_t triangle);

/// The triangle's normal of length 1; zero if it has no area.
Vec3 unit_normal(const Mesh& mesh, std::uint32_t triangle);
/// The unit normals of all triangles.
std::vector<Vec3> unit_normals(const Mesh& mesh);

/// Metres.
double longest_side(const Mesh& mesh, std::uint32_t triangle);
/// The triangle's height over its longest side, metres.
double triangle_width(const Mesh& mesh, std::uint32_t triangle);
/// The triangle's height over its longest side, metres, from twice its area.
double triangle_width(const Mesh& mesh, std::uint32_t triangle, double twice_area);

/// Groups of indices that are merged step by step; the smallest index represents its group.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count);
  std::uint32_t find(std::uint32_t item);
  void join(std::uint32_t a, std::uint32_t b);

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace palpa::geometry
