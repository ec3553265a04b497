// The slots that a plan plays, and the drive of each of them. Planner, output, links, guards and boards all use this
// one value and do not copy its fields one by one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "array/schedule.hpp"

namespace palpa::session {

/// The maximum number of drives that a plan lists.
inline constexpr std::uint32_t most_cycle = 128;

/// The cycle that repeats in the slots of a plan, and the modulation of all slots.
struct Cycle {
  /// Number of drives that the plan lists; slot s plays drive s % length. At most most_cycle. 0: the plan lists none.
  std::uint32_t length = 0;
  /// The reason why the plan lists no drives. True: its schedule does not repeat within most_cycle slots (odd dwells
  /// with several modulations), so the drive of each slot is computed when the slot plays. False: there is nothing to
  /// drive, because there is no finger or no array.
  bool too_long = false;
  /// If not 0, the listed drives do not include the modulation that all fingers share. The amplitudes of slot s must be
  /// multiplied by array::modulation_gain(modulation, modulation_hz, (s + 0.5) * slot_s).
  double modulation_hz = 0;
  array::Modulation modulation = array::Modulation::pressure_sine;

  bool is_listed() const { return length > 0; }
  /// The number of slots, from slot 0 on, that represent all slots: one cycle, or most_cycle if the plan lists no
  /// drives.
  std::uint32_t slots_to_look_at() const { return is_listed() ? length : most_cycle; }
};

/// The slots in which a plan plays.
struct Slots {
  std::uint64_t from = 0;  ///< the first slot that plays it
  /// The first slot in which it may no longer sound. If no other plan came before, silence begins there.
  std::uint64_t until = 0;
  Cycle cycle{};

  std::uint64_t count() const { return until - std::min(from, until); }
};

}  // namespace palpa::session
