// The slots that a plan plays, and the drive of each of them. Planner, output, links, guards and boards all use this
// one value and do not copy its fields one by one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "array/schedule.hpp"

namespace palpa::session {

/// The maximum number of drives that a plan lists.
inline constexpr std::uint32_t most_cycle = 128;

/// What the slots of a plan play.
enum class Plays : std::uint32_t {
  nothing,  ///< there is no finger or no array: silence
  pattern,  ///< the drives that the plan lists
  /// A drive of its own in each slot, known when the slot plays: the schedule does not repeat within most_cycle slots
  /// (odd dwells with several modulations), or, for a link, foci or gains change from cycle to cycle.
  slot_by_slot,
};

/// The cycle that repeats in the slots of a plan, and the modulation of all slots.
struct Cycle {
  Plays plays = Plays::nothing;
  /// Number of drives that a pattern lists; slot s plays drive s % length. At most most_cycle. Otherwise 0.
  std::uint32_t length = 0;
  /// If not 0, the listed drives do not include the modulation that all fingers share. The amplitudes of slot s must be
  /// multiplied by array::modulation_gain(modulation, modulation_hz, (s + 0.5) * slot_s).
  double modulation_hz = 0;
  array::Modulation modulation = array::Modulation::pressure_sine;

  bool is_listed() const { return plays == Plays::pattern; }
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
