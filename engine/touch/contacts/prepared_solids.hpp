// The solids of a scene in the form in which contacts are asked for: planes of convex ones, surfaces
// (geometry/surface/surface.hpp) or tables of convex parts of any others, and where they are.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/solid.hpp"
#include "geometry/surface/surface.hpp"
#include "shaders/touch/contacts/contacts.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// Where a solid's surface begins in the scene's buffers.
struct SurfaceBase {
  std::uint32_t cells = 0, runs = 0, triangles = 0, corners = 0;
};

/// What solids were prepared for: contacts up to how deep, where a solid has no delta of its own; and deep points.
struct MadeFor {
  double delta_m = 0;
  bool deep = false;
};

/// The solids of one scene, relative to each solid's centre and in single precision.
struct PreparedSolids {
  std::vector<shader::SolidRecord> records;  ///< posed
  std::vector<shader::PlaneCell> cells;      ///< solid after solid, x fastest
  std::vector<shader::vec4> planes;          ///< first every plane of every solid, then the cells' lists
  std::vector<std::uint32_t> first_plane;    ///< per solid, plus one past the last: the range of all its planes
  std::vector<geometry::Surface> surfaces;   ///< per solid; empty where it is asked by its planes
  std::vector<SurfaceBase> surface_base;     ///< per solid
  std::vector<Vec3> centres;                 ///< per solid, where it was made
  /// Per solid, what takes it from where it was made to its place in the scene: nothing but for rigid copies, which
  /// share the surface of the first.
  std::vector<Transform> T_rest_made;
  std::vector<std::uint32_t> foci_of;  ///< foci_of_solids()
  std::vector<shader::uvec4> parts;    ///< see parts_table.hpp; empty without solids of convex parts
  MadeFor made_for;
  std::string file;              ///< where the solids are from, for messages; empty where they are not from a file
  std::uint32_t iterations = 0;  ///< contact_iterations()

  /// The solid's delta: its own where it has one.
  double delta_m(std::uint32_t solid, const Parameters& parameters) const {
    return records[solid].delta > 0 ? static_cast<double>(records[solid].delta) : parameters.delta_m;
  }
};

/// N of each solid's fingers where its model says one (1 to max_foci), else 0: the parameters' N. Throws bad_usage
/// naming the solid for another number.
std::vector<std::uint32_t> foci_of_solids(const std::vector<geometry::Solid>& solids);

/// Half the longest side of the solid's box, metres.
double half_size(const shader::SolidRecord& solid);

/// The least finger gap with which a cluster's cells can be numbered wherever in the solid it is, however that is
/// turned, metres.
double least_finger_gap(const shader::SolidRecord& solid);

/// A convex solid gets its planes and their cells (plane_cells.hpp). A solid without planes, or with so many that its
/// surface is quicker, gets its surface, made for the delta of `parameters` (or its own) and for deep points where they
/// are asked for; check_parameters() refuses others. Rigid copies share one; where there are many surfaces each has
/// fewer cells. A solid of convex parts gets a table of those. Throws bad_input naming a solid's file where it would
/// cost too much (docs/limits.md) or is too large for the finger gap; bad_usage naming the solid where planes or box
/// are not finite, and where all solids together have more triangles than shader::surface_most_triangles.
PreparedSolids prepare_solids(const std::vector<geometry::Solid>& solids, const Parameters& parameters = {});

/// Moves a solid: from now on it is where T_world_rest takes it from its place in the scene. Nothing is rebuilt. Throws
/// bad_usage for a solid that there is not, and for what is no rigid motion.
void set_pose(PreparedSolids& solids, std::uint32_t solid, const Transform& T_world_rest);

/// The world's box around all solids where they are now, grown by a hair against rounding: skin outside of it needs no
/// look.
Box touchable_box(const PreparedSolids& solids);

}  // namespace palpa::touch
