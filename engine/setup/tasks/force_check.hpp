// The force by momentum in the air (acoustics/bodies/far_force.hpp) beside the one by radiation pressure: two ways to
// the same number, one without the slopes of the pressure on the surface.
#pragma once

#include <string>

#include "acoustics/bodies/radiation.hpp"
#include "base/math.hpp"

namespace palpa::setup {

/// Warns if the radiation force on `body` differs by more than 3 % from `far_force`, in N. Differences below 0.3 % of
/// the integral of the pressure's magnitude do not count: where pushes cancel, no force is left to compare.
void warn_of_force(const std::string& body, const acoustics::SkinPressure& pressure, const Vec3& far_force);

}  // namespace palpa::setup
