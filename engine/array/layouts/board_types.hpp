// The types of boards that palpa knows, one record each: where the transducers are, and what the electronics can play.
// Everything that depends on a board's type asks its record. Its driver (driver/NAME/) has only what is sent to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/amplitude_steps.hpp"
#include "array/layouts/changes.hpp"
#include "base/math.hpp"

namespace palpa::array {

struct BoardType {
  std::string_view name;   ///< in layouts, of its link and its emulator, and of the built-in layout of one board
  std::string_view title;  ///< for people
  double width_m = 0, height_m = 0;        ///< along the board's x and y
  double pitch_m = 0;                      ///< from one transducer to the next, along both
  void (*add_places)(std::vector<Vec3>&);  ///< adds those of its transducers, in its own order, z = 0
  std::uint32_t phase_steps = 0;           ///< in a turn
  /// How loud a null may be, relative to the weakest focus, with phases rounded to these steps
  /// (solvers/common_phase.hpp).
  double null_depth = 0;
  /// The amplitudes of its transducers. Null: they are on or off. The largest amplitude of a drive is then the share of
  /// them that are on, and `turn` says in which order they go on: 0 is the first.
  const AmplitudeSteps* (*amplitudes)() = nullptr;
  std::uint32_t (*turn)(std::uint32_t transducer) = nullptr;
  /// Below this amplitude it has too few steps for deep nulls; 0: never.
  double few_amplitudes = 0;
  /// How late each further board of an array runs after the first one, in periods, by the source of its firmware.
  double follower_lag = 0;
  /// How it goes to the next drive (array/layouts/changes.hpp). Null: it jumps.
  Changes (*changes)(const ChangeSetting&) = nullptr;
  bool may_jump = false;  ///< --steps off lets it jump
  /// The usual slot of foci that stand still; 0: that of others.
  double still_slot_s = 0;
  /// It modulates foci that stand still by its own clock, in slots of at most this; 0: their drives are modulated.
  double modulation_slot_s = 0;
  /// The shortest slot in which foci may move, if its line is slow, for an array of that many boards. Null: any.
  double (*moving_slot_s)(std::size_t boards) = nullptr;
  std::string_view link_words;  ///< the argument of its link, for people: "a serial port"

  bool has_amplitudes() const { return amplitudes != nullptr; }
};

/// In the order of their names.
std::span<const BoardType> board_types();
/// Null for an unknown type.
const BoardType* find_board_type(std::string_view name);
/// Their names as text for people: "autd3, openmpd, ...".
std::string known_board_types();

}  // namespace palpa::array
