// Leaves out tracked hands that are in doubt: no skin is better than skin where there is no hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

/// Why a hand is left out, in the order in which it is looked for.
enum class HandDoubt : std::uint32_t {
  clock,   ///< the tracker's clock does not run in seconds, or started again: all hands are left out
  crowd,   ///< more than two hands, or two of the same side: all hands are left out
  far,     ///< a joint is farther than farthest_joint_m from the tracker's origin
  size,    ///< a radius or a bone is no person's
  jump,    ///< a joint moved faster than fastest_joint_m_s since the frame before
  frozen,  ///< no joint has moved by a bit for longest_rest_s
};

inline constexpr double farthest_joint_m = 10;
inline constexpr double least_radius_m = 1e-3, most_radius_m = 40e-3, longest_bone_m = 0.15;
inline constexpr double fastest_joint_m_s = 5;
inline constexpr double longest_rest_s = 0.25;
/// After a longer gap, a hand may be anywhere, but not where it was to the bit.
inline constexpr double longest_gap_s = 0.25;
/// Frames come with delays that differ by less than this. The tracker's clock is trusted again after it has run evenly
/// for as long.
inline constexpr double longest_delay_s = 1;

/// One tracker's frames, in the order of their times.
class HandCheck {
 public:
  /// Removes the hands in doubt. `arrived_s` is on palpa's clock; of a file's frame, its own time. Returns the doubt
  /// about the last of them.
  std::optional<HandDoubt> check(TrackedFrame& frame, double arrived_s);

 private:
  /// A hand as it came last.
  struct Seen {
    bool known = false;
    TrackedHand hand;
    double time_s = 0;   ///< on the tracker's clock
    double moved_s = 0;  ///< on palpa's
  };
  bool trusts_clock(double time_s, double arrived_s);
  std::optional<HandDoubt> doubt_of(const TrackedHand& hand, double time_s, double arrived_s);

  int frames_ = 0;  ///< the first two are counted
  bool trusted_ = true;
  double ahead_s_ = 0, since_s_ = 0;  ///< what the tracker's clock was ahead of palpa's, and when
  std::array<Seen, 2> seen_;          ///< right, left
};

/// What is left out: "a hand with a joint that moved faster than 5 m/s".
std::string to_text(HandDoubt doubt);

}  // namespace palpa::sensing
