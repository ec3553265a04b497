// Which slots a plan plays, and what each of them plays. Planner, output, links, guards and boards all hold this one
// value, and none of them copies its fields one by one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "array/schedule.hpp"

namespace palpa::session {

/// A plan lists at most so many drives.
inline constexpr std::uint32_t most_cycle = 128;

/// What repeats in the slots of a plan, and the modulation of all of them.
struct Cycle {
  /// Slot s plays drive s % length of the plan's; there are as many drives. At most most_cycle. 0: the plan lists none.
  std::uint32_t length = 0;
  /// Why the plan lists no drives. On: its schedule does not repeat within most_cycle slots (odd dwells with several
  /// modulations), so that the drive of each slot is computed when the slot plays. Off: there is nothing to drive,
  /// since there is no finger, or no array.
  bool too_long = false;
  /// Where not 0, the listed drives are without the modulation that all fingers share: the amplitudes of slot s are
  /// multiplied by array::modulation_gain(modulation, modulation_hz, (s + 0.5) * slot_s).
  double modulation_hz = 0;
  array::Modulation modulation = array::Modulation::pressure_sine;

  bool is_listed() const { return length > 0; }
  /// How many slots, from slot 0 on, stand for all: one cycle, or the first most_cycle where the plan lists none.
  std::uint32_t slots_to_look_at() const { return is_listed() ? length : most_cycle; }
};

/// The slots in which a plan plays.
struct Slots {
  std::uint64_t from = 0;  ///< the first that plays it
  /// The slot from which on it may no longer sound: then comes silence, if no other plan came before.
  std::uint64_t until = 0;
  Cycle cycle{};

  std::uint64_t count() const { return until - std::min(from, until); }
};

}  // namespace palpa::session
