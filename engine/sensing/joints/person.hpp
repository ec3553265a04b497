// Whether a tracked hand can be a person's: trackers put joints at zero, or all in one place, when they lose a hand.
//
// The limits hold for hands from a two-year-old's (wrist to tip about 95 mm; Snyder et al. 1977, "Anthropometry of
// infants, children, and youths to age 18") to the longest (99 % of men's are shorter than 220 mm; Greiner 1991, "Hand
// anthropometry of U.S. Army personnel"), with room for trackers, whose joints lie up to 10 mm beside the real ones.
// Proportions are those of adults' bones (Buryanov and Kotiuk 2010, "Proportions of hand segments": index to little
// finger 78, 88, 84 and 67 mm from knuckle to tip, thumb with its metacarpal 99 mm, metacarpals 54 to 68 mm), again
// with room: they only find joints that are elsewhere, not odd hands.
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
/// 42 % of the hand's length.
inline constexpr Limits hand_size_m{30e-3, 115e-3};

/// These are relative to the hand's size.
inline constexpr Limits finger_length{0.5, 1.5};  ///< of the four fingers, from knuckle to tip along the bones
inline constexpr Limits thumb_length{0.5, 2.2};   ///< of all its bones
inline constexpr Limits metacarpal_length{0, 2};  ///< zero: from a tracker without metacarpals
/// Between the knuckles of fingers side by side.
inline constexpr Limits knuckles_apart{0.05, 0.8};
/// From the palm to the first and second joint of each finger, and to the wrist.
inline constexpr Limits from_palm{0, 2};

/// A bone of a finger beyond its metacarpal (of the thumb, also that), relative to the sum of all these.
inline constexpr Limits bone_part{0.04, 0.75};
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
