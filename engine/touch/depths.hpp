// How deep a finger presses.
#pragma once

#include "touch/types.hpp"

namespace palpa::touch {

/// A deep point farther than that from the box around a finger's contacts belongs to no finger.
inline constexpr float deep_reach_m = 0.03F;

/// Fills `depth_m` of the first `finger_count` fingers: the depth of their deepest skin point. Those are a finger's
/// contacts, and of the touch's deep points, where they were asked for, the ones of the same solid that are nearer to
/// the box around its contacts than to that of any other finger (of two equally near, the nearer centroid; then the
/// first). Without deep points no depth exceeds delta. The result does not depend on the order of points.
void find_depths(Touch& touch);

}  // namespace palpa::touch
