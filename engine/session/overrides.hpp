// What a solid asks for itself: the `extras` of its node take the place of what the command line says for all.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "array/schedule.hpp"
#include "geometry/solid.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// Foci per finger on that solid.
std::uint32_t foci_on(const geometry::Solid& solid, const touch::Parameters& all);
/// Stride, dwell and intensity on that solid.
array::VoiceOptions voice_on(const geometry::Solid& solid, const array::VoiceOptions& all);
/// Whether the solid asks for foci, stride or dwell of its own, whatever they are.
bool has_own_schedule(const geometry::Solid& solid);

/// How long one drive must last for the dwells of all solids: what divides them all, in whole nanoseconds. Where that
/// is less than shortest_slot_s it is the shortest dwell, and longer ones last for whole slots only on average.
inline constexpr double shortest_slot_s = 0.25e-3;
double slot_length(std::span<const geometry::Solid> solids, const array::VoiceOptions& all);

/// Throws bad_input naming `file`, node and a stride that would do, where a solid's stride and foci (its own or the
/// command line's) share a divisor: some of its foci would never sound.
void check_overrides(const std::string& file, std::span<const geometry::Solid> solids, const touch::Parameters& all,
                     const array::VoiceOptions& voice);

}  // namespace palpa::session
