// How each solid is felt: the haptics of its node, and the session's values for everything that the node leaves open.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// One solid's haptics with all values resolved that can be.
struct SolidHaptics {
  std::uint32_t foci = 0;     ///< per finger
  array::VoiceOptions voice;  ///< stride, dwell, intensity and pressure
  bool own_schedule = false;  ///< it sets foci, stride or dwell itself, whatever their values
};

/// One entry per solid, computed once for a session. `touch` and `voice` are the common values. Throws bad_usage if the
/// common stride and foci share a divisor, so that some foci would never sound, or if the common pressure is out of
/// range. Throws bad_input naming `scene` and node if this holds for a solid's own values.
std::vector<SolidHaptics> resolve_haptics(const std::string& scene, std::span<const geometry::Solid> solids,
                                          const touch::FingerOptions& touch, const array::VoiceOptions& voice);

/// The duration of one drive that suits the dwells of all solids: their greatest common divisor, in whole nanoseconds.
/// If that is less than shortest_slot_s, the shortest dwell is used, and longer dwells are then correct only on
/// average, in whole slots. Without solids, it is the common dwell.
inline constexpr double shortest_slot_s = 0.25e-3;
double slot_length(std::span<const SolidHaptics> solids, const array::VoiceOptions& voice);

}  // namespace palpa::session
