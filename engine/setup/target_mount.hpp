// Where the calibration target (sensing/target.hpp) stands on an array.
#pragma once

#include "array/layout.hpp"
#include "base/math.hpp"
#include "sensing/target.hpp"

namespace palpa::setup {

struct TargetMount {
  Transform T_layout_target{1.0};
  sensing::TargetHoles holes;  ///< four of them stand over gaps between transducers; none where there are none known
};

/// Of a layout in its own frame. Of boards: flat on the first one, middle on middle, the board's x and y along the
/// target's. `paper`: head down from the tunnel's ceiling, across the four units in its middle, x along x and y along
/// z. Of bare transducers: at the layout's origin.
TargetMount target_mount(const array::Layout& layout);

/// The target as it stands elsewhere: its origin there, and turned about its own z.
Transform moved_mount(const TargetMount& mount, const Vec3& origin_m, double turn_rad);

}  // namespace palpa::setup
