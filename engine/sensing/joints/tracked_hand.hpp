// Hands as a tracker sees them: the 26 joints of OpenXR's XR_EXT_hand_tracking, in the tracker's own frame.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/math.hpp"

namespace palpa::sensing {

inline constexpr std::size_t joint_count = 26;

/// The joints by number, as XrHandJointEXT has them. Palm and wrist have the numbers 0 and 1. A finger's joints have
/// consecutive numbers from its metacarpal to its tip; the thumb has four joints, each other finger five.
inline constexpr std::array<std::pair<std::size_t, std::size_t>, 5> finger_joints{
    {{2, 5}, {6, 10}, {11, 15}, {16, 20}, {21, 25}}};
inline constexpr std::size_t palm_joint = 0, wrist_joint = 1, index_tip_joint = 10;

struct TrackedHand {
  bool left = false;
  std::array<Vec3, joint_count> joints{};     ///< metres
  std::array<double, joint_count> radii_m{};  ///< from the joint to the skin
  bool operator==(const TrackedHand&) const = default;
};

/// All hands at one time. Without a hand, it says that there is none.
struct TrackedFrame {
  double time_s = 0;  ///< capture, on the tracker's clock
  std::vector<TrackedHand> hands;
  bool in_doubt = false;  ///< it had hands that were left out (hand_check.hpp)
};

}  // namespace palpa::sensing
