// The place of the calibration target (sensing/target.hpp) on an array.
#pragma once

#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "sensing/target.hpp"

namespace palpa::setup {

struct TargetMount {
  Transform T_layout_target{1.0};
  sensing::TargetHoles holes;  ///< four of them are over gaps between transducers; empty if the gaps are unknown
};

/// The mount for a layout in its own frame. On boards, the target lies flat on the first board, middle on middle, with
/// the board's x and y along the target's. On `paper`, it hangs upside down from the tunnel's ceiling, across the four
/// units in its middle, with x along x and y along z. For bare transducers, it is at the layout's origin.
TargetMount target_mount(const array::Layout& layout);

/// The pose of a moved target: its origin is at `origin_m`, and it is turned about its own z.
Transform moved_mount(const TargetMount& mount, const Vec3& origin_m, double turn_rad);

}  // namespace palpa::setup
