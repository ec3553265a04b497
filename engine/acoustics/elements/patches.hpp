// A body's surface as curved patches, over which boundary elements integrate. A mesh's flat faces cut off some of a
// smooth body's volume, which changes the scattered wave. The curvature between the vertices is estimated from the mesh
// alone.
//
// Every face becomes a second-order patch,
//
//   x(u, v) = c0 + u c1 + v c2 + u^2 c3 + u v c4 + v^2 c5,   u, v >= 0, u + v <= 1,
//
// through its corners, at (0, 0), (1, 0) and (0, 1), and the middles of its sides. The bulge of a side is the mean of
// the bulges of two arcs. Like the cubics of Vlachos et al. (2001, "Curved PN triangles"), each arc is perpendicular to
// the normal at one end of the side. The bulge is exact on a sphere. The normal of a vertex is that of Max (1999),
// which is exact if the vertex's neighbours lie on a sphere. An edge where the surface turns by more than sharp_turn
// stays a straight edge, and the faces on its two sides do not share normals. Neighbouring patches meet without gaps.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

/// If the normals of an edge's faces differ by more than this, it is an edge of the body. In radians.
inline constexpr double sharp_turn = 40 * std::numbers::pi / 180;

struct Patch {
  std::array<Vec3, 6> c;

  Vec3 at(double u, double v) const { return c[0] + u * (c[1] + u * c[3] + v * c[4]) + v * (c[2] + v * c[5]); }
  Vec3 along_u(double u, double v) const { return c[1] + 2 * u * c[3] + v * c[4]; }
  Vec3 along_v(double u, double v) const { return c[2] + u * c[4] + 2 * v * c[5]; }
  /// Outward normal times the area per unit of (u, v) at that point.
  Vec3 area_vector(double u, double v) const { return glm::cross(along_u(u, v), along_v(u, v)); }
};

struct Patches {
  geometry::Mesh mesh;              ///< as given: patch i is its triangle i
  std::vector<std::uint32_t> twin;  ///< geometry::twins of the mesh
  std::vector<std::uint8_t> sharp;  ///< by side (geometry/mesh/topology.hpp): whether the surface has a sharp edge
                                    ///< there
  std::vector<Patch> patches;
};

/// `mesh` is welded, closed and oriented; its triangles have an area.
Patches make_patches(geometry::Mesh mesh);

}  // namespace palpa::acoustics
