// For each cell of a convex solid's box, the planes that can be the nearest one. With these lists, Eq. (1) costs only a
// few planes per skin point, however many faces the solid has. The result does not change.
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
/// few others as a bound on the cell allows). A plane is left out only if another one is nearer by more than the
/// rounding error, so the least float depth over the list is bit for bit the least over all planes. Cells deeper than a
/// few millimetres are coarser; they are slower but equally correct. If the lists would take more than `most_listed`
/// entries, a single cell lists all planes.
PlaneCells make_plane_cells(const std::vector<LocalPlane>& planes, const Vec3& low, const Vec3& high,
                            std::size_t most_listed);

/// Cells deeper than this are not refined further, because no sensible delta reaches there.
inline constexpr double refined_depth = 5e-3;

/// How far a box with these half sides reaches from its centre along a direction, times the direction's length.
double half_width(const Vec3& direction, const Vec3& half);

/// The nearest float that is not greater than `value`, and the nearest that is not less.
float rounded_down(double value);
float rounded_up(double value);

}  // namespace palpa::touch
