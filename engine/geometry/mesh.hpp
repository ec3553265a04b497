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

/// Merges vertices with bit-equal positions (-0 equals 0), drops triangles that lose a corner to it and vertices that no
/// triangle uses. Order of first use is kept, so the result does not depend on how the input was indexed.
Mesh weld(const Mesh& mesh);

/// Appends `more` to `mesh`, indices shifted.
void append(Mesh& mesh, const Mesh& more);

Box bounds(const Mesh& mesh);

/// Volume by the divergence theorem: positive when triangles face outwards.
double signed_volume(const Mesh& mesh);

/// What keeps a welded mesh from enclosing a volume. Edges are pairs of vertex indices of the mesh.
struct Defects {
  std::uint64_t open = 0;          ///< edges with a triangle on one side only
  std::uint64_t non_manifold = 0;  ///< edges with more than two triangles
  std::uint64_t flipped = 0;       ///< edges whose two triangles run along it in the same direction
  std::array<std::uint32_t, 2> first_open{}, first_non_manifold{}, first_flipped{};
  bool closed_and_oriented() const { return open == 0 && non_manifold == 0 && flipped == 0; }
};
Defects find_defects(const Mesh& welded);

}  // namespace palpa::geometry
