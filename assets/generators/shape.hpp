// Functions that several generators use.
#pragma once

#include <cstdint>

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// `count` consecutive vertices of a mesh that form a ring; a ring of one vertex is a pole.
struct Ring {
  std::uint32_t first;
  std::uint32_t count;
};

/// Sews ring a to ring b with a.count + b.count triangles (fewer if one is a pole), always by the shorter diagonal. The
/// triangles face outwards if a lies above b and both run counter-clockwise seen from above.
void sew(geometry::Mesh& mesh, Ring a, Ring b);

/// The connected piece with the most triangles; their order is kept.
geometry::Mesh largest_shell(const geometry::Mesh& mesh);

/// Rounds every coordinate to the nearest 32-bit float, so that the mesh in memory equals the one in the file.
void round_to_float(geometry::Mesh& mesh);

/// The smallest angle of any triangle, radians.
double smallest_angle(const geometry::Mesh& mesh);

}  // namespace palpa::assets
