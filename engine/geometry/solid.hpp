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

/// What counts as a solid's surface.
enum class SurfaceKind {
  mesh,   ///< the mesh itself: exact
  parts,  ///< its convex parts, the paper's way
};
inline constexpr Word<SurfaceKind> surface_words[] = {{"mesh", SurfaceKind::mesh}, {"parts", SurfaceKind::parts}};

/// Solids of one shape are rigid copies of one another.
struct CopyOfShape {
  std::shared_ptr<const void> shape;
  Transform T_world_shape{1.0};  ///< what the copies have in common, their scale, is in here, too
};

struct Solid {
  std::string name;           ///< the glTF node's name
  Mesh mesh;                  ///< world coordinates, welded, closed, facing outwards
  std::vector<Plane> planes;  ///< of a convex mesh: one per distinct face plane, coplanar triangles merged; else empty
  Box bounds;
  Haptics haptics{};  ///< of the node; of several pieces, the first one's
  /// Where its surface is that of convex parts: those; else none. Then `mesh` holds the parts' hulls side by side, for
  /// drawing, and there are no planes.
  Parts parts{};
  InternalFaces internal_faces = InternalFaces::drop;  ///< what counts as the parts' surface
  std::string file{};                                  ///< where it is from, for messages
  CopyOfShape copy{};                                  ///< no shape where nothing is to be shared
};

/// Metres, positive inside. Of a convex solid Eq. (1), min over faces m of (x_m - x) . n_m: the exact depth for points
/// inside; outside it is minus the distance to the worst plane, a lower bound of the distance. Of any other the exact
/// distance from the surface, by looking at every triangle: for tests and single points. 0 outside of parts.
double depth(const Solid& solid, const Vec3& point);

/// The solids of a scene, in node order. Meshes that are open by themselves but closed together (CAD exports split
/// faces over nodes) become one solid, named after the first of them. Nodes that are not touchable are scenery.
/// Vertices are welded where positions are equal; where that leaves a mesh open, those within flatness_tolerance of
/// each other are, too. A mesh may be concave, have holes through it, several shells and cavities. Mended, with a
/// warning: inside out, duplicated faces; silently: needles (solid_mesh.hpp). Throws bad_input, one line naming file,
/// mesh and place: no touchable mesh at all; open, non-manifold or inconsistently oriented (how many edges, and one of
/// them); flat; larger than a kilometre or smaller than a micrometre; passing through itself, touching itself or folded
/// (two triangles), unless `kind` is parts; a shell inside another that faces the same way. What a large mesh was found
/// to be is cached (base/cache_file.hpp), and what the first of many rigid copies was found to be holds for all
/// (rigid_copies.hpp). Refused, too: what would cost too much to check (docs/limits.md). Nodes that are marked as
/// convex parts (palpa decompose writes them) become solids of parts, whatever `kind` is; for their errors see
/// parts_solid.hpp.
std::vector<Solid> make_solids(const Scene& scene, SurfaceKind kind = SurfaceKind::mesh);

/// What decompose() is for: as make_solids(scene, SurfaceKind::parts), but a mesh that is open even together with what
/// it meets, non-manifold or inconsistently oriented is there as it is, welded.
std::vector<Solid> solids_to_decompose(const Scene& scene);

}  // namespace palpa::geometry
