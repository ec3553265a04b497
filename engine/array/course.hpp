// How a voice's gain changes from slot to slot: by the depth of its finger, and by the roughness of the surface at its
// place. Plain values, like the schedule.
//
// A frame brings the newest values. They are reached one frame later and in even steps, so that no gain jumps. In a
// slot, the radiation pressure is this share of that at the full gain, and the gain is the share's square root:
//
//   force (steady + motion (grain_1 low s_low + grain_2 high s_high)) / (steady + low + high)
//
//   s: a sine between 0 and 1 at low_hz or high_hz, sampled at the slot's midpoint; grain: noise_at(place)
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/math.hpp"

namespace palpa::array {

/// The weights of what a surface feels like: a steady pressure, and vibrations at low_hz and high_hz. At least 0, and
/// not all 0.
struct Texture {
  double steady = 1, low = 0, high = 0;
  bool operator==(const Texture&) const = default;
};
inline constexpr double low_hz = 30, high_hz = 150;

/// Solid noise, 0 to 1: independent random values at whole coordinates, and smooth between them. Another seed gives
/// independent noise. The same on every machine.
double noise_at(const Vec3& place, std::uint32_t seed);

struct Course {
  struct Values {
    double force = 1;   ///< 0..1, by the finger's depth
    double motion = 0;  ///< 0..1: the part of the vibrations that plays
    Vec3 place{0};      ///< of the finger on its solid, in grains
    bool operator==(const Values&) const = default;
  };
  static constexpr std::uint64_t endless = std::numeric_limits<std::uint64_t>::max();

  Values from, to;
  std::uint64_t first_slot = 0;  ///< it and the slots before it have the values `from`,
  std::uint32_t slots = 0;       ///< and after so many more slots, they are `to`; 0: all slots have them
  Texture texture;
  /// Slots before the first of these, and from the second on, are silent.
  std::uint64_t begin_slot = 0, end_slot = endless;
  /// If it is not empty, these are the gains of the slots from first_slot on, and the last one stays. For schedules
  /// that are played again.
  std::vector<double> gains;

  /// False: the gain is the same in all slots.
  bool changes() const;
  Values at(std::uint64_t slot) const;
  bool operator==(const Course&) const = default;
};

/// The factor of the gain in a slot, 0..1. 1 for Course{}.
double modulate(const Course& course, std::uint64_t slot, double slot_s);

}  // namespace palpa::array
