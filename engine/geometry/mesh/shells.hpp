// The pieces of a closed mesh, and which of them lies inside which.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh/bvh.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::geometry {

/// Triangles that hang together by edges.
struct Shell {
  std::uint32_t first = 0;      ///< its first triangle
  double volume = 0, area = 0;  ///< m^3, negative where it faces inwards; m^2
  std::uint32_t depth = 0;      ///< how many shells it lies inside of
  /// The innermost of those, and the outermost; its own number where there is none.
  std::uint32_t parent = 0, outermost = 0;
};

struct Shells {
  std::vector<Shell> list;  ///< in the order of their first triangles
  std::vector<std::uint32_t> of_triangle;
};

/// `mesh` is closed and oriented, `twin` its twins.
Shells find_shells(const Mesh& mesh, std::span<const std::uint32_t> twin);

/// Fills depth, parent and outermost. The shells must not meet. Method: a ray from each shell's farthest vertex along
/// some direction, where it never meets its own shell again. The first other shell that the ray meets is its parent if
/// the ray leaves that one there; if it enters it, the two have the same parent. Crossings are exact (predicates.hpp);
/// where rounding could change which is the first, or the ray grazes an edge, another direction is taken.
void find_nesting(const Mesh& mesh, const Bvh& bvh, Shells& shells);

/// Turns the triangles of the shells that are marked.
void flip(Mesh& mesh, const Shells& shells, const std::vector<char>& marked);

}  // namespace palpa::geometry
