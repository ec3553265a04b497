// The connected pieces of a closed mesh, and how they are nested.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Triangles that are connected by edges.
struct Shell {
  std::uint32_t first = 0;      ///< its first triangle
  double volume = 0, area = 0;  ///< m^3, negative if it faces inwards; m^2
  std::uint32_t depth = 0;      ///< number of shells that contain it
  /// The innermost and the outermost shell that contain it; its own number if there is none.
  std::uint32_t parent = 0, outermost = 0;
};

struct Shells {
  std::vector<Shell> list;  ///< in the order of their first triangles
  std::vector<std::uint32_t> of_triangle;
};

/// `mesh` is closed and oriented, `twin` its twins.
Shells find_shells(const Mesh& mesh, std::span<const std::uint32_t> twin);

/// Fills depth, parent and outermost. The shells must not meet. Method: cast a ray from each shell's farthest vertex in
/// some direction, where it cannot meet its own shell again. If the ray leaves the first other shell that it meets,
/// that shell is the parent; if it enters it, the two have the same parent. Crossings are exact (predicates.hpp). If
/// rounding could change which crossing is first, or the ray grazes an edge, another direction is used.
void find_nesting(const Mesh& mesh, const Bvh& bvh, Shells& shells);

/// Reverses the triangles of the marked shells.
void flip(Mesh& mesh, const Shells& shells, const std::vector<char>& marked);

}  // namespace palpa::geometry
