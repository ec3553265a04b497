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

/// Merges vertices with bit-equal positions (-0 equals 0), drops triangles that lose a corner to it and vertices that
/// no triangle uses. Order of first use is kept, so the result does not depend on how the input was indexed.
Mesh weld(const Mesh& mesh);

/// As weld(mesh), but a vertex joins the first earlier one that lies within `tolerance` metres of it: for seams whose
/// two sides were rounded differently. Positions keep the first one's value.
Mesh weld(const Mesh& mesh, double tolerance);

/// For each position the index of the first one (in this order) that it joins: bit-equal, or within `tolerance` metres
/// of it.
std::vector<std::uint32_t> weld_indices(const std::vector<Vec3>& positions, double tolerance = 0);

/// Appends `more` to `mesh`, indices shifted.
void append(Mesh& mesh, const Mesh& more);

/// Turns every triangle over.
void flip(Mesh& mesh);

Box bounds(const Mesh& mesh);

/// Square metres, all triangles.
double area(const Mesh& mesh);

/// Volume by the divergence theorem, cubic metres: positive when triangles face outwards.
double signed_volume(const Mesh& mesh);

/// What keeps a welded mesh from enclosing a volume. Edges are pairs of vertex indices of the mesh, "first" in their
/// ascending order (for an open edge in the direction of its triangle).
struct Defects {
  std::uint64_t open = 0;          ///< edges with a triangle on one side only
  std::uint64_t non_manifold = 0;  ///< edges with more than two triangles
  std::uint64_t flipped = 0;       ///< edges whose two triangles run along it in the same direction
  std::array<std::uint32_t, 2> first_open{}, first_non_manifold{}, first_flipped{};
  bool closed_and_oriented() const { return open == 0 && non_manifold == 0 && flipped == 0; }
};
Defects find_defects(const Mesh& welded);

}  // namespace palpa::geometry
