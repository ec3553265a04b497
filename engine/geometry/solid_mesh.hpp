// Makes a welded mesh fit to be a solid: mends what can be mended, refuses the rest.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

struct SolidMesh {
  Mesh mesh;                          ///< closed, facing outwards
  std::vector<Plane> planes;          ///< of a convex one
  std::vector<std::string> warnings;  ///< what was mended; begins after "mesh NAME "
};

/// The mesh with equal positions merged; where that leaves it open, with those within flatness_tolerance() of each
/// other merged; where that leaves edges with more than two faces, without duplicated faces. What closes it is kept,
/// else the first of these.
SolidMesh weld_closed(const Mesh& mesh);

/// Checks and mends, in this order; throws bad_input naming file and mesh.
/// - Size, closedness, orientation of neighbours.
/// - Needles: triangles narrower than needle_width() with a corner beside their longest side give that side up
/// (turn_needles).
/// - Shells without a volume are refused.
/// - Self-intersection, touching of parts that do not share a vertex, and folds are refused, unless `may_cross`.
/// - Shells: an outermost one that faces inwards is turned with all that lies in it, with a warning; one inside another
/// faces the
///   other way, a cavity, or is refused.
/// - A convex mesh gets its planes.
void make_fit(const std::string& file, const std::string& name, SolidMesh& solid, bool may_cross);

}  // namespace palpa::geometry
