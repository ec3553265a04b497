// How each solid is felt: what the haptics of its node ask for, and the session's values for what they leave open.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// One solid's haptics with nothing left open but what may stay so.
struct SolidHaptics {
  std::uint32_t foci = 0;     ///< per finger
  array::VoiceOptions voice;  ///< stride, dwell, intensity and pressure
  bool own_schedule = false;  ///< it asks for foci, stride or dwell itself, whatever they are
};

/// One entry per solid, once for a session; `touch` and `voice` hold for all of them. Throws bad_usage where stride and
/// foci that hold for all share a divisor, so that some foci would never sound, and on a pressure out of
/// range; bad_input naming `scene` and node where
/// a solid's do.
std::vector<SolidHaptics> resolve_haptics(const std::string& scene, std::span<const geometry::Solid> solids,
                                          const touch::Parameters& touch, const array::VoiceOptions& voice);

/// How long one drive must last for the dwells of all solids: what divides them all, in whole nanoseconds. Where that
/// is less than shortest_slot_s it is the shortest dwell, and longer ones last for whole slots only on average. The
/// dwell that holds for all where there is no solid.
inline constexpr double shortest_slot_s = 0.25e-3;
double slot_length(std::span<const SolidHaptics> solids, const array::VoiceOptions& voice);

}  // namespace palpa::session
