// Where a tracked hand's joint is, and how the hand is turned.
#pragma once

#include <cstddef>

#include "base/math.hpp"
#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

/// The pose of a joint, in the tracker's frame, with the palm's axes: y from the wrist to the knuckle of the middle
/// finger, x to the hand's right if its back is up, and z out of its back. Over an array, a hand with the palm down and
/// the fingers away from the user has the array's axes. A hand without an extent has the tracker's axes.
Transform pose_of_joint(const TrackedHand& hand, std::size_t joint);

}  // namespace palpa::sensing
