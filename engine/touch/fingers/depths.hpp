// The depth to which a finger presses.
#pragma once

#include "touch/fingers/sight.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A deep point that is farther than this from the box around a finger's contacts belongs to no finger.
inline constexpr float deep_reach_m = 0.03F;

/// Fills `depth_m` of the first `finger_count` fingers: the depth of their deepest firm skin point (is_firm()); 0 if
/// none is. A finger's skin points are its contacts and, if deep points were requested, the touch's deep points of the
/// same solid that are nearer to the box around its contacts than to the box of any other finger. If two boxes are
/// equally near, the nearer centroid decides, then the first finger. Without cameras, all points are firm. Without deep
/// points, no depth exceeds delta. The result does not depend on the order of points.
void find_depths(const Sight& sight, Touch& touch);

}  // namespace palpa::touch
