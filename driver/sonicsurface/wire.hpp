// What SonicSurface boards are sent: single bytes at 230400 baud, 8N1, without any answer.
//
//   254        phases follow, for the slots 0 to 255 (only if the board is selected)
//   253        the buffers change places on all boards: what was written sounds, what sounded is written next
//   192, 193   only the primary or only the secondary board takes phases from now on, also for the next program
//   others     a phase: 0 to 31 in 1/32 turns of delay, 32 is off
//
// The tactile firmware drops a phase's last bit (16 steps), takes 0xa0 to 0xbf as the speed of its own modulation, and
// knows no second board. Amplitudes are on or off.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "array/transducer_drive.hpp"

namespace palpa::driver::sonicsurface {

inline constexpr std::size_t transducers = 256;                   ///< of a board
inline constexpr double bits_per_byte = 10, board_baud = 227556;  ///< the boards' actual speed at 230400
inline constexpr std::uint8_t begin = 254, swap = 253, primary = 192, secondary = 193, off = 32;

enum class Firmware { plain, tactile };

/// The place of a transducer's phase on the wire. Transducer 16 r + c is in column c from the left and row r from the
/// bottom, seen from the side on which the board emits sound.
constexpr std::size_t slot_of(std::size_t transducer) {
  constexpr std::size_t within[4][2] = {{0, 4}, {7, 3}, {1, 6}, {2, 5}};
  const std::size_t row = transducer / 16, column = transducer % 16;
  return 64 * (column / 4) + 8 * (row / 2) + within[column % 4][row % 2];
}

/// How long that many bytes take. To be on the safe side, at the board's speed.
constexpr double seconds_of(std::size_t bytes) {
  return static_cast<double>(bytes) * bits_per_byte / board_baud;
}
/// The size of a frame for that many boards: 258 bytes for one, 517 for two.
constexpr std::size_t frame_size(std::size_t boards) {
  return boards == 1 ? 1 + transducers + 1 : boards * (2 + transducers) + 1;
}

/// Converts drives to frames: which transducers sound, and when. The boards take no amplitudes: a transducer is off if
/// its amplitude is 0. Links get drives in this form (array/layouts/board_play.hpp).
class Encoder {
 public:
  /// `degrees` says how late each transducer of all boards sounds. Empty: none is late. `lag` is that of the secondary
  /// board, in periods (driver/lag.hpp).
  Encoder(std::size_t boards, Firmware firmware, std::vector<float> degrees = {}, double lag = 0);

  std::size_t size() const { return frame_size(boards_); }
  /// Writes a frame, swap included.
  void encode(std::span<const array::TransducerDrive> drive, std::span<std::uint8_t> frame) const;
  /// All off, in both buffers, on every board that may be there. A single board may have been deselected by the program
  /// that had it before, and a second one behind it sounds since it was switched on. Afterwards, the primary board is
  /// selected. A board with the tactile firmware that was opened without `tactile` is silent in both buffers, too.
  std::vector<std::uint8_t> all_off() const;
  /// The same for its own boards only. This is enough after all_off(), and half as long for one board.
  std::vector<std::uint8_t> own_off() const;

 private:
  template <typename Phase>
  void write(std::span<std::uint8_t> frame, const Phase& phase) const;
  std::uint8_t phase_of(std::size_t transducer, float phase) const;
  void add_off(std::vector<std::uint8_t>& bytes, std::initializer_list<std::uint8_t> selections) const;

  std::size_t boards_;
  Firmware firmware_;
  std::vector<float> degrees_;
  double lag_;
};

}  // namespace palpa::driver::sonicsurface
