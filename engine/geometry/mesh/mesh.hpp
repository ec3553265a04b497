// Triangle meshes on the host: welding, closedness, orientation, bounds.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "base/math.hpp"

namespace palpa::geometry {

/// Positions in metres; each triangle's corners counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<glm::uvec3> triangles;
};

/// Merges vertices with bit-equal positions (-0 equals 0). Drops triangles that lose a corner by this, and vertices
/// that no triangle uses. Keeps the order of first use, so the result does not depend on the input's indexing.
///
/// With a `tolerance`, a vertex is merged into the first earlier one within so many metres: for seams whose two sides
/// were rounded differently. The position of the first vertex is kept.
Mesh weld(const Mesh& mesh, double tolerance = 0);

/// For each position, the index of the first position (in this order) that it is merged into: bit-equal, or within
/// `tolerance` metres.
std::vector<std::uint32_t> weld_indices(const std::vector<Vec3>& positions, double tolerance = 0);

/// Appends `more` to `mesh`, indices shifted.
void append(Mesh& mesh, const Mesh& more);

/// Reverses the orientation of every triangle.
void flip(Mesh& mesh);

Box bounds(const Mesh& mesh);

/// Square metres, all triangles.
double area(const Mesh& mesh);

/// Volume by the divergence theorem, cubic metres: positive if triangles face outwards.
double signed_volume(const Mesh& mesh);

/// Defects that keep a welded mesh from enclosing a volume. Edges are pairs of vertex indices of the mesh; "first"
/// refers to their ascending order (an open edge is given in the direction of its triangle).
struct Defects {
  std::uint64_t open = 0;          ///< edges with a triangle on one side only
  std::uint64_t non_manifold = 0;  ///< edges with more than two triangles
  std::uint64_t flipped = 0;       ///< edges whose two triangles run along it in the same direction
  std::array<std::uint32_t, 2> first_open{}, first_non_manifold{}, first_flipped{};
  bool closed_and_oriented() const { return open == 0 && non_manifold == 0 && flipped == 0; }
};
Defects find_defects(const Mesh& welded);

}  // namespace palpa::geometry
