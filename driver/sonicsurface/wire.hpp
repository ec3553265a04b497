// What SonicSurface boards are told: single bytes at 230400 baud, 8N1, that nobody answers.
//
//   254        phases follow, for the slots 0 to 255 (only where the board is selected)
//   253        the buffers change places, on all boards: what was written sounds, what sounded is the one to be written
//   192, 193   the primary board, the secondary board alone takes phases from now on, for whoever has it open next, too
//   others     a phase: 0 to 31 in 1/32 turns of delay, 32 is off
//
// The tactile firmware drops a phase's last bit (16 steps), takes 0xa0 to 0xbf as the speed of a modulation of its own,
// and knows no second board. Amplitudes are on or off.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "array/drive.hpp"

namespace palpa::driver::sonicsurface {

inline constexpr std::size_t transducers = 256;                   ///< of a board
inline constexpr double bits_per_byte = 10, board_baud = 227556;  ///< what the boards make of 230400
inline constexpr std::uint8_t begin = 254, swap = 253, primary = 192, secondary = 193, off = 32;

enum class Firmware { plain, tactile };

/// Where a transducer's phase stands on the wire; transducer 16 r + c in column c from the left and row r from the top.
constexpr std::size_t slot_of(std::size_t transducer) {
  constexpr std::size_t within[4][2] = {{0, 4}, {7, 3}, {1, 6}, {2, 5}};
  const std::size_t row = transducer / 16, column = transducer % 16;
  return 64 * (column / 4) + 8 * (row / 2) + within[column % 4][row % 2];
}

/// How long that many bytes take, to be on the safe side: as long as the board would.
constexpr double seconds_of(std::size_t bytes) {
  return static_cast<double>(bytes) * bits_per_byte / board_baud;
}
/// A frame for so many boards: 258 bytes for one, 517 for two.
constexpr std::size_t frame_size(std::size_t boards) {
  return boards == 1 ? 1 + transducers + 1 : boards * (2 + transducers) + 1;
}

/// Drives to frames: which transducers sound, and when. Amplitudes cannot be told, so a drive is taken as if all its
/// transducers that sound did so equally: those whose amplitude is 0 are off, and where its largest amplitude is less
/// than 1 (a ceiling, a ramp, a modulation) so many of the others are off, evenly spread, that the part that sounds is
/// that amplitude.
class Encoder {
 public:
  /// `degrees`, per transducer of all boards, is by how much it sounds late. Empty: none of them does.
  Encoder(std::size_t boards, Firmware firmware, std::vector<float> degrees = {});

  std::size_t size() const { return frame_size(boards_); }
  /// Writes a frame, swap included.
  void encode(std::span<const array::TransducerDrive> drive, std::span<std::uint8_t> frame) const;
  /// All off, in both buffers, on every board that may be there: one board alone may have been deselected by whoever
  /// had it before, and a second one behind it sounds since it was switched on. The primary one is selected afterwards.
  /// A board with the tactile firmware that was opened without saying so is silent in both buffers, too.
  std::vector<std::uint8_t> all_off() const;
  /// The same for its own boards alone: enough, and half as long for one, where all_off() has gone before.
  std::vector<std::uint8_t> own_off() const;

 private:
  template <typename Phase>
  void write(std::span<std::uint8_t> frame, const Phase& phase) const;
  std::uint8_t phase_of(std::size_t transducer, float phase) const;
  void add_off(std::vector<std::uint8_t>& bytes, std::initializer_list<std::uint8_t> selections) const;

  std::size_t boards_;
  Firmware firmware_;
  std::vector<float> degrees_;
  std::vector<float> places_;  ///< 0..1, evenly spread: a transducer is heard where its amplitude is more
};

}  // namespace palpa::driver::sonicsurface
