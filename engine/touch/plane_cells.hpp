// Which planes of a convex solid can be the nearest one, cell by cell of its box: makes Eq. (1) cost a handful of
// planes per skin point, however many faces the solid has, without changing its result.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/solid.hpp"
#include "shaders/contacts.h"

namespace palpa::touch {

/// The planes of all solids for one scene, relative to each solid's centre and in single precision.
struct PlaneTable {
  std::vector<shader::SolidRecord> solids;
  std::vector<shader::PlaneCell> cells;    ///< solid after solid, x fastest
  std::vector<shader::vec4> planes;        ///< first every plane of every solid, then the cells' lists
  std::vector<std::uint32_t> first_plane;  ///< per solid, plus one past the last: the range of all its planes
};

/// `solids` are convex and bounded. A cell of solid s lists every plane that is the nearest at some point of the cell
/// (and as few others as a bound on the cell allows). A plane is left out only where another is nearer by more than
/// rounding, so that the least float depth over the list is bit for bit the least over all planes. Cells deeper than a
/// few millimetres are coarser: no less right, only slower. Throws bad_usage naming the solid where planes or box are
/// not finite.
PlaneTable make_plane_table(const std::vector<geometry::Solid>& solids);

}  // namespace palpa::touch
