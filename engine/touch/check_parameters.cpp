#include "touch/check_parameters.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "shaders/fingers.h"

namespace palpa::touch {

void check_parameters(const Parameters& parameters, const PreparedSolids& solids) {
  if (!std::isfinite(parameters.delta_m) || parameters.delta_m <= 0) {
    throw bad_usage(fmt::format("delta is {} m: give a positive length such as 1.5mm", parameters.delta_m));
  }
  if (!std::isfinite(parameters.finger_gap_m) || parameters.finger_gap_m <= 0) {
    throw bad_usage(fmt::format("the finger gap is {} m: give a positive length such as 5mm", parameters.finger_gap_m));
  }
  if (!std::isfinite(parameters.finger_width_m) || parameters.finger_width_m < 0) {
    throw bad_usage(fmt::format("the finger width is {} m: give a length such as 25mm, or 0 to join nothing",
                                parameters.finger_width_m));
  }
  if (parameters.foci < 1 || parameters.foci > max_foci) {
    throw bad_usage(fmt::format("{} foci: give 1 to {}", parameters.foci, max_foci));
  }
  for (std::uint32_t s = 0; s < solids.records.size(); ++s) {
    if (solids.records[s].asked_by != shader::asked_by_surface) continue;
    const geometry::SurfaceOptions& made = solids.surfaces[s].options;
    if (solids.delta_m(s, parameters) > made.reach_m * (1 + 1e-6) || (parameters.wants_deep() && !made.deep)) {
      throw bad_usage(
          fmt::format("solid {} was prepared for contacts up to {} m deep{}; prepare it for these parameters", s,
                      made.reach_m, made.deep ? "" : " and no deep points"));
    }
  }
  for (const shader::SolidRecord& solid : solids.records) {
    const double least = least_finger_gap(solid);
    if (parameters.finger_gap_m < least) {
      throw bad_usage(fmt::format("the finger gap is {} m: at least {:.3g} m for a solid of {:.3g} m",
                                  parameters.finger_gap_m, least * 1.01, 2 * half_size(solid)));
    }
  }
}

}  // namespace palpa::touch
