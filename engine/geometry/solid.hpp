// A solid: a touchable object. For now it must be convex, so that "inside? how deep?" is Eq. (1) of the paper.
#pragma once

#include <string>
#include <vector>

#include "geometry/convex.hpp"
#include "geometry/gltf.hpp"
#include "geometry/haptics.hpp"
#include "geometry/mesh.hpp"

namespace palpa::geometry {

struct Solid {
  std::string name;           ///< the glTF node's name
  Mesh mesh;                  ///< world coordinates, welded, closed, facing outwards
  std::vector<Plane> planes;  ///< one per distinct face plane of the mesh, coplanar triangles merged
  Box bounds;
  Haptics haptics;  ///< as the node has it
};

/// Eq. (1): min over faces m of (x_m - x) . n_m, metres, positive inside. The exact depth for points inside a convex
/// solid; outside it is minus the distance to the worst plane, a lower bound of the distance.
double depth(const Solid& solid, const Vec3& point);

/// The solids of a scene, in node order; of a node that is not touchable none is made. Meshes that are open by
/// themselves but closed together (CAD exports split faces over nodes) become one solid, named after the first of them.
/// Vertices are welded where positions are equal; where that leaves a mesh open, those within flatness_tolerance of
/// each other are, too. Throws bad_input naming file and mesh: no mesh at all; open, non-manifold or inconsistently
/// oriented (how many edges, and one of them); flat; larger than a kilometre or smaller than a micrometre; made of
/// several shells; concave (a reflex edge and its angle). A mesh that is inside out is turned, with a warning.
std::vector<Solid> make_solids(const Scene& scene);

}  // namespace palpa::geometry
