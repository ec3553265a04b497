// Whether a tracked hand can be a person's: trackers put joints at zero, or all in one place, when they lose a hand.
//
// The limits are palpa's own choice, with much room on both sides: a small child's hand is about half as large as an
// adult's, a large man's a fifth larger, and trackers put joints up to 10 mm beside the real ones. So they find joints
// that are elsewhere, not odd hands. The tests try them on hands of 50 % to 130 % of an adult's in many poses, and on
// recordings of a Leap controller.
#pragma once

#include <cstdint>
#include <optional>

#include "sensing/joints/tracked_hand.hpp"

namespace palpa::sensing {

/// From the least to the most that is plausible.
struct Limits {
  double least = 0, most = 0;
  /// False for NaN.
  constexpr bool hold(double value) const { return value >= least && value <= most; }
};

/// Radii: of the joints from the knuckle to the tip, for the thumb from its second joint on, and of all joints.
inline constexpr Limits finger_radius_m{3e-3, 25e-3}, any_radius_m{3e-3, 40e-3};
/// A hand's size is the median length of the four fingers beside the thumb, from knuckle to tip along the bones: about
/// 80 mm for an adult.
inline constexpr Limits hand_size_m{30e-3, 115e-3};

/// These are relative to the hand's size.
inline constexpr Limits finger_length{0.5, 1.5};    ///< of the four fingers, from knuckle to tip along the bones
inline constexpr Limits thumb_length{0.5, 2.2};     ///< of all its bones
inline constexpr Limits metacarpal_length{0, 1.6};  ///< zero: from a tracker without metacarpals
/// Between the knuckles of fingers side by side.
inline constexpr Limits knuckles_apart{0.07, 0.8};
/// Between the knuckles of the index and the little finger.
inline constexpr Limits palm_width{0.4, 1.6};
/// The same, relative to the sum of the three distances between: knuckles lie nearly in a row.
inline constexpr Limits knuckle_row{0.6, 1.001};
/// The least cosine of the angle between metacarpals side by side.
inline constexpr double metacarpals_cosine = 0.3;
/// From the wrist to the knuckles of the four fingers: about as long as these, however they are bent.
inline constexpr Limits palm_length{0.25, 2.1};
/// From the palm to the first and second joint of each finger, and to the wrist.
inline constexpr Limits from_palm{0, 2};

/// A bone of a finger beyond its metacarpal (of the thumb, also that), relative to the sum of all these.
inline constexpr Limits bone_part{0.05, 0.75};
/// From the beginning of a bone to the end of the next one, relative to the sum of both: fingers do not fold flat. For
/// the metacarpal and the first bone, and for this and the second one.
inline constexpr Limits bend{0.4, 1.001};
/// From the wrist to where a finger's metacarpal begins, relative to the distance to where it ends.
inline constexpr Limits palm_root{0, 1.2};
/// A radius of a finger, relative to the median of all fingers'.
inline constexpr Limits radius_part{0.4, 2.5};

/// What is no person's.
enum class Misfit : std::uint32_t {
  radius,  ///< a radius, alone or beside the others
  size,    ///< the hand's size
  shape,   ///< a bone, or a finger's place, relative to the hand's size
};

/// What is found first, in this order; nullopt for a hand that can be a person's.
std::optional<Misfit> misfit_of(const TrackedHand& hand);

}  // namespace palpa::sensing
