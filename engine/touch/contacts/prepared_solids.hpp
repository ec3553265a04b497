// The solids of a scene in the form in which contacts are looked up: planes for convex solids, surfaces
// (geometry/surface/surface.hpp) or tables of convex parts for all others, and their poses.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "geometry/surface/surface.hpp"
#include "shaders/touch/contacts/contacts.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// The offsets of a solid's surface in the scene's buffers.
struct SurfaceBase {
  std::uint32_t cells = 0, runs = 0, triangles = 0, corners = 0;
};

/// What the solids were prepared for: the maximum depth of contacts in a solid without its own delta, and whether deep
/// points are found.
struct MadeFor {
  double delta_m = 0;
  bool deep = false;
};

/// The solids of one scene, relative to each solid's centre and in single precision.
struct PreparedSolids {
  std::vector<shader::SolidRecord> records;  ///< posed
  std::vector<shader::PlaneCell> cells;      ///< solid after solid, x fastest
  std::vector<shader::vec4> planes;          ///< the cells' lists
  std::vector<geometry::Surface> surfaces;   ///< per solid; empty if the solid is looked up by its planes
  std::vector<SurfaceBase> surface_base;     ///< per solid
  std::vector<Vec3> centres;                 ///< per solid, in the place where it was made
  /// Per solid, the transform from the place where it was made to its place in the scene. It is the identity except for
  /// rigid copies, which share the surface of the first copy.
  std::vector<Transform> T_rest_made;
  std::vector<std::uint32_t> foci_of;  ///< foci_of_solids()
  std::vector<shader::uvec4> parts;    ///< see parts_table.hpp; empty without solids of convex parts
  MadeFor made_for;
  std::string file;              ///< the file the solids come from, for messages; empty if there is none
  std::uint32_t iterations = 0;  ///< contact_iterations()

  /// The solid's own delta if it has one, otherwise that of the parameters.
  double delta_m(std::uint32_t solid, const FingerOptions& parameters) const {
    return records[solid].delta > 0 ? static_cast<double>(records[solid].delta) : parameters.delta_m;
  }
};

/// The N of each solid's fingers if its model gives one (1 to max_foci), otherwise 0, which means the parameters' N.
/// Throws bad_usage naming the solid if the number is out of range.
std::vector<std::uint32_t> foci_of_solids(const std::vector<geometry::Solid>& solids);

/// Half the longest side of the solid's box, metres.
double half_size(const shader::SolidRecord& solid);

/// The least finger gap in metres with which a cluster's cells can be numbered anywhere in the solid, however the solid
/// is turned.
double least_finger_gap(const shader::SolidRecord& solid);

/// A convex solid gets its planes and their cells (plane_cells.hpp). A solid without planes, or with so many planes
/// that its surface is quicker, gets its surface. The surface is made for the delta of `parameters` (or the solid's
/// own) and for deep points if they are requested; check_parameters() refuses other parameters. Rigid copies share one
/// surface. If there are many surfaces, each has fewer cells. A solid of convex parts gets a table of its parts. Throws
/// bad_input naming a solid's file if the solid would cost too much (docs/limits.md) or is too large for the finger
/// gap. Throws bad_usage naming the solid if its planes or box are not finite, and bad_usage if all solids together
/// have more triangles than shader::surface_most_triangles.
PreparedSolids prepare_solids(const std::vector<geometry::Solid>& solids, const FingerOptions& parameters = {});

/// The last result of prepare_solids, for those who prepare the same solids again and again. Any thread may use it.
class KeptSolids {
 public:
  /// As prepare_solids. `solids` must be the same in every call.
  PreparedSolids prepare(const std::vector<geometry::Solid>& solids, const FingerOptions& parameters);

 private:
  std::mutex mutex_;
  std::shared_ptr<const PreparedSolids> last_;
  double finger_gap_m_ = 0;  ///< with which it was checked
};

/// A solid whose centre is farther than this from the origin, along any axis, is out of reach: no camera sees skin
/// there.
inline constexpr double out_of_reach_m = 100;

/// Moves a solid: from now on, T_world_rest takes it from its place in the scene to its new place. Nothing is rebuilt.
/// A solid that is moved out of reach is not touched, and costs nothing in touchable_box(). Throws bad_usage if there
/// is no such solid or if the transform is not a rigid motion.
void set_pose(PreparedSolids& solids, std::uint32_t solid, const Transform& T_world_rest);

/// The box in world coordinates around all solids within reach in their current poses, slightly enlarged against
/// rounding. Skin outside this box can be ignored. It is a point at the origin if no solid is within reach.
Box touchable_box(const PreparedSolids& solids);

}  // namespace palpa::touch
