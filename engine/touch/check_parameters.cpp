#include "touch/check_parameters.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace palpa::touch {

void check_parameters(const FingerOptions& parameters, const PreparedSolids& solids) {
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
  const MadeFor& made = solids.made_for;
  const bool uses_delta = std::any_of(solids.records.begin(), solids.records.end(),
                                      [](const shader::SolidRecord& solid) { return solid.delta == 0; });
  if ((uses_delta && parameters.delta_m > made.delta_m * (1 + 1e-6)) || (parameters.wants_deep() && !made.deep)) {
    throw bad_usage(
        fmt::format("the solids were prepared for contacts up to {} m deep{}; prepare them for these parameters",
                    made.delta_m, made.deep ? "" : " and no deep points"));
  }
  for (const shader::SolidRecord& solid : solids.records) {
    const double least = least_finger_gap(solid);
    if (parameters.finger_gap_m < least) {
      throw bad_usage(fmt::format("the finger gap is {} m; a solid of {:.3g} m needs at least {:.3g} m",
                                  parameters.finger_gap_m, 2 * half_size(solid), least * 1.01));
    }
  }
}

}  // namespace palpa::touch
