// Which of a convex solid's planes can be the nearest one, cell by cell of its box: makes Eq. (1) cost a handful of
// planes per skin point, however many faces the solid has, without changing its result.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math.hpp"
#include "shaders/touch/contacts/contacts.h"

namespace palpa::touch {

/// A plane relative to its solid's centre; inside is where dot(normal, p) < offset.
struct LocalPlane {
  Vec3 normal;
  double offset;
};

struct PlaneCells {
  std::uint32_t per_axis = 1;
  std::vector<shader::PlaneCell> cells;  ///< x fastest; `first` counts in `list`
  std::vector<std::uint32_t> list;       ///< planes
};

/// The box reaches from `low` to `high`. A cell lists every plane that is the nearest at some point of the cell (and as
/// few others as a bound on the cell allows). A plane is left out only where another is nearer by more than rounding,
/// so that the least float depth over the list is bit for bit the least over all planes. Cells deeper than a few
/// millimetres are coarser: no less right, only slower. Where lists would take more than `most_listed` entries, one
/// cell lists all planes.
PlaneCells make_plane_cells(const std::vector<LocalPlane>& planes, const Vec3& low, const Vec3& high,
                            std::size_t most_listed);

/// The nearest float that is not greater, not less.
float rounded_down(double value);
float rounded_up(double value);

}  // namespace palpa::touch
