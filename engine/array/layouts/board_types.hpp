// The types of boards that palpa knows, one record each: where the transducers are, and what the electronics can play.
// Everything that depends on a board's type asks its record. Its driver (driver/NAME/) has only what is sent to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/changes.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// The amplitudes that a transducer of a board can play. Between silence and full amplitude there is only a limited
/// number of pulse widths, and the smallest of them is the least amplitude that sounds.
class AmplitudeSteps {
 public:
  struct Step {
    double level;       ///< amplitude, 0 to 1
    std::uint8_t code;  ///< the number that the board is sent for it
  };
  /// Levels ascend from 0 to 1; at most 256 of them.
  explicit AmplitudeSteps(const std::vector<Step>& steps);

  /// The amplitude of step `number`, from 0 on.
  float level(std::size_t number) const { return levels_[number]; }
  std::uint8_t code(std::size_t number) const { return codes_[number]; }
  /// The least amplitude that sounds.
  float least() const { return levels_[1]; }

  /// The highest step that is not above the amplitude, apart from rounding to a float. NaN and what is below 0 count as
  /// 0, and what is above 1 as 1.
  std::size_t below(float amplitude) const;
  /// The step nearest to the amplitude, at most `most`; the lower one of two that are equally near.
  std::size_t nearest(float amplitude, std::size_t most) const;

 private:
  static constexpr std::size_t entries = 1024;
  std::vector<float> levels_;
  std::vector<std::uint8_t> codes_;
  std::array<std::uint8_t, entries + 1> below_{};  ///< the highest step not above i / entries
};

/// What every board emits: a firmware divides its clock to 40 kHz, and takes no other frequency.
inline constexpr double board_frequency_hz = 40e3;

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
  /// It modulates foci that stand still by its own clock, in samples that last so long at this frequency. Null: their
  /// drives are modulated.
  double (*modulation_slot_s)(double hz) = nullptr;
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
