// A solid: a touchable object, made of any closed mesh.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/words.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/haptics.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/parts/convex.hpp"
#include "geometry/parts/parts.hpp"

namespace palpa::geometry {

/// What counts as the surface of a solid.
enum class SurfaceKind {
  mesh,   ///< the mesh itself: exact
  parts,  ///< its convex parts, as in the paper
};
inline constexpr Word<SurfaceKind> surface_words[] = {{"mesh", SurfaceKind::mesh}, {"parts", SurfaceKind::parts}};

/// Solids of one shape are rigid copies of each other.
struct CopyOfShape {
  std::shared_ptr<const void> shape;
  Transform T_world_shape{1.0};  ///< includes the scale that all copies share
};

struct Solid {
  std::string name;           ///< the glTF node's name
  Mesh mesh;                  ///< world coordinates, welded, closed, facing outwards
  std::vector<Plane> planes;  ///< of a convex mesh: one per distinct face plane, coplanar triangles merged; empty
                              ///< otherwise
  Box bounds;
  Haptics haptics{};  ///< of the node; for several pieces, the first one's
  /// The convex parts, if they form the surface; otherwise empty. With parts, `mesh` holds their hulls side by side,
  /// for drawing, and `planes` is empty.
  Parts parts{};
  InternalFaces internal_faces = InternalFaces::drop;  ///< what counts as the parts' surface
  std::string file{};                                  ///< its source, for messages
  CopyOfShape copy{};                                  ///< no shape if nothing is shared
};

/// Metres, positive inside. For a convex solid Eq. (1), min over faces m of (x_m - x) . n_m: the exact depth for points
/// inside; outside it is minus the distance to the worst plane, a lower bound of the distance. For any other solid, the
/// exact distance from the surface, found by testing every triangle: for tests and single points. 0 outside of parts.
double depth(const Solid& solid, const Vec3& point);

/// The solids of a scene, in node order. Meshes that are open individually but closed together (CAD exports split faces
/// over nodes) become one solid, named after the first of them. Nodes that are not touchable are scenery. Vertices with
/// equal positions are welded; if the mesh is then still open, so are vertices within flatness_tolerance of each other.
/// A mesh may be concave, have holes through it, several shells and cavities.
///
/// Repaired with a warning: inside out, duplicated faces; silently: needles (solid_mesh.hpp). Throws bad_input, one
/// line naming file, mesh and place: no touchable mesh at all; open, non-manifold or inconsistently oriented (how many
/// edges, and one of them); flat; larger than a kilometre or smaller than a micrometre; passing through itself,
/// touching itself or folded (two triangles), unless `kind` is parts; a shell inside another that faces the same way.
/// Meshes that would cost too much to check are also refused (docs/limits.md).
///
/// Results for a large mesh are cached (base/files/cache_file.hpp), and results for the first of many rigid copies hold
/// for all (rigid_copies.hpp). Nodes that are marked as convex parts (palpa decompose writes them) become solids of
/// parts for any `kind`; for their errors see parts_solid.hpp.
std::vector<Solid> make_solids(const Scene& scene, SurfaceKind kind = SurfaceKind::mesh);

/// The input of decompose(): as make_solids(scene, SurfaceKind::parts), but a mesh that is non-manifold, inconsistently
/// oriented, or open even together with adjoining meshes is included as it is, welded.
std::vector<Solid> solids_to_decompose(const Scene& scene);

}  // namespace palpa::geometry
