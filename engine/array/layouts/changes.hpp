// How boards go from one drive to the next, which the ear hears (acoustics/audible.hpp), and in which slots they play.
// What a type of board can is in its record (board_types.hpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "array/layouts/layout.hpp"

namespace palpa::array {

struct BoardType;

/// Even steps, phases by the shorter way round. The first step sounds from the beginning of the slot on. A transducer
/// that was off takes its new phase, and one that goes off keeps its old one.
struct Changes {
  std::uint32_t step_periods = 1;  ///< of the carrier that a step lasts
  std::uint32_t phase_steps = 1;   ///< 1: they jump
  std::uint32_t amplitude_steps = 1;
  bool silence_jumps = true;  ///< to a drive of zeros, without steps
};

/// What the changes of boards depend on.
struct ChangeSetting {
  double slot_s = 1.5e-3;
  std::size_t boards_of_bus = 1;  ///< how many share a USB bus
  bool steps = true;              ///< --steps, for boards that may jump
  bool nulls = false;             ///< drives are silent at places, and what lies between two drives is not: they jump

  /// At least one; of board_frequency_hz.
  std::uint32_t periods() const;
};

/// Null: the board is of no known type, and jumps.
Changes changes_of(const BoardType* type, const ChangeSetting& setting);

/// One line that says why boards play fewer steps than slots have room for; empty if they do not. For a board that may
/// jump, it also says how to avoid the warning.
std::string why_fewer_steps(const BoardType* type, const ChangeSetting& setting);

/// The type of a layout's boards; null if it has none, they are of several types, or the type is unknown.
const BoardType* board_type_of(const Layout& layout);

/// The slots in which foci that stand still sound on these boards if nobody gives a dwell: a modulation in such fine
/// steps is quieter. 0: those of other foci, also if one USB bus could not carry the steps of all boards.
double still_slot_s(const Layout& layout);

}  // namespace palpa::array
