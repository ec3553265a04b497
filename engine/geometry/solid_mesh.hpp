// Prepares a welded mesh as a solid: repairs what can be repaired, refuses the rest.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"

namespace palpa::geometry {

struct SolidMesh {
  Mesh mesh;                          ///< closed, facing outwards
  std::vector<Plane> planes;          ///< only of a convex one
  std::vector<std::string> warnings;  ///< the repairs; each begins after "mesh NAME "
};

/// Merges equal positions. If the mesh is then open, also merges positions within flatness_tolerance() of each other;
/// if edges then have more than two faces, also removes duplicated faces. Returns the first result that is closed, else
/// the result of the first step.
SolidMesh weld_closed(const Mesh& mesh);

/// Checks and repairs, in this order; throws bad_input naming file and mesh.
/// - Size, closedness, orientation of neighbours.
/// - Needles: triangles narrower than needle_width() with a corner beside their longest side have that side flipped
///   (turn_needles).
/// - Shells without a volume are refused.
/// - Self-intersection, touching of parts that do not share a vertex, and folds are refused, unless `may_cross`.
/// - Shells: an outermost shell that faces inwards is reversed with everything inside it, with a warning. A shell
///   inside another must face the other way (a cavity), or is refused.
/// - A convex mesh gets its planes.
void make_fit(const std::string& file, const std::string& name, SolidMesh& solid, bool may_cross);

}  // namespace palpa::geometry
