// Flying pixels: those that a depth camera sees beside the rim of a thing, between it and what lies behind.
#pragma once

#include <vector>

#include "sensing/skin_point.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::viewer {

/// Moves them from `points` to the end of `leavings`, which are drawn faintly: they are not firm (touch::is_firm()).
/// Both keep their order.
void part_flying(const touch::Sight& sight, std::vector<sensing::SkinPoint>& points,
                 std::vector<sensing::SkinPoint>& leavings);

}  // namespace palpa::viewer
