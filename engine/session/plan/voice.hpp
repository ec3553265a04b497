// A finger's part of the schedule: the interface between touching and sounding.
#pragma once

#include <cstdint>

#include "array/schedule.hpp"
#include "touch/methods/method.hpp"
#include "touch/types.hpp"

namespace palpa::session {

/// Turns the foci that a method has placed (touch/methods/method.hpp) into the voice of the finger `id` on `solid`. An
/// empty sector takes the position of the nearest non-empty one by angle; if two are equally near, the one with the
/// lower index. If all foci sound together, an empty sector is left out, because its neighbour would be twice as loud.
/// The placement must have at least one focus with a position.
void make_voice(const touch::Placement& placement, std::uint32_t id, std::uint32_t solid,
                const array::VoiceOptions& options, array::Voice& voice);

/// The schedule with a voice for each finger that was seen, in their order. A finger that is expected to have left when
/// its foci would sound has no voice in the plan; it gets one without foci.
array::Schedule by_finger(const array::Schedule& plan, const touch::Touch& seen);

}  // namespace palpa::session
