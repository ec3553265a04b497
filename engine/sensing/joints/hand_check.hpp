// Leaves out tracked hands that are in doubt: no skin is better than skin where there is no hand.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

/// Why a hand is left out.
enum class HandDoubt : std::uint32_t {
  clock,   ///< the tracker's clock does not run in seconds, or started again: all hands are left out
  crowd,   ///< more than two hands, or two of the same side: all hands are left out
  far,     ///< a joint is farther than farthest_joint_m from the tracker's origin
  radius,  ///< a radius is no person's, alone or beside the others (person.hpp)
  size,    ///< the hand is no person's: too small, or too large
  shape,   ///< a bone does not fit the others, or a finger is not at its hand
  jump,    ///< a joint moved faster than fastest_joint_m_s since the frame before
  side,    ///< a left hand came as a right one went, or the reverse, less than longest_gap_s ago
  frozen,  ///< no joint has moved by a bit for longest_rest_s
};

inline constexpr double farthest_joint_m = 10;
inline constexpr double fastest_joint_m_s = 5;
inline constexpr double longest_rest_s = 0.25;
/// After a longer gap, a hand may be anywhere, but not where it was to the bit.
inline constexpr double longest_gap_s = 0.25;
/// One hand does not come within longest_gap_s where the other went, and hardly ever in the frame after.
inline constexpr double same_place_m = 0.2;
/// Frames come with delays that differ by less than this. The tracker's clock is trusted again after it has run evenly
/// for as long.
inline constexpr double longest_delay_s = 1;

/// One tracker's frames, in the order of their times.
class HandCheck {
 public:
  /// Removes the hands in doubt, and says so in the frame. `arrived_s` is on palpa's clock; of a file's frame, its own
  /// time. Returns the doubt about the last of them.
  std::optional<HandDoubt> check(TrackedFrame& frame, double arrived_s);

 private:
  /// A hand as it came last.
  struct Seen {
    bool known = false;
    TrackedHand hand;
    double time_s = 0;   ///< on the tracker's clock
    double moved_s = 0;  ///< on palpa's
  };
  std::optional<HandDoubt> remove_doubtful(TrackedFrame& frame, double arrived_s);
  bool trusts_clock(double time_s, double arrived_s);
  bool changed_side(const TrackedFrame& frame) const;
  std::optional<HandDoubt> doubt_of(const TrackedHand& hand, double time_s, double arrived_s);

  int frames_ = 0;  ///< the first two are counted
  bool trusted_ = true;
  double ahead_s_ = 0, since_s_ = 0;  ///< what the tracker's clock was ahead of palpa's, and when
  std::array<Seen, 2> seen_;          ///< right, left
  std::array<bool, 2> before_{};      ///< whether the frame before had them
  std::optional<double> side_s_;      ///< when a hand changed its side last, on palpa's clock
};

/// What is left out: "a hand with a joint that moved faster than 5 m/s".
std::string to_text(HandDoubt doubt);

}  // namespace palpa::sensing
