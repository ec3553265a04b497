// What an OpenMPD board is sent: frames of 512 bytes, one byte per pin, 256 phases and then 256 amplitudes.
//
// The board has each transducer on during counts [phase, phase + width) of the 128 of a period, 25 us. A pulse of that
// width has the amplitude sin(pi width / 128), where 64 is full, and the delay of its middle:
//
//   width = that of the highest step that is not above the amplitude (array/layouts/board_types.hpp)
//   phase = floor(128 (phase / 2 pi - offset / 360 - lag) + (64 - width) / 2 + 1/2) mod 128
//
// The offset is the transducer's own (board_file.hpp), and the lag is the board's (driver/lag.hpp). The amplitude
// already has the transducer's factor (factors_of). A transducer that is off has phase 0, so an all-zero drive is the
// all-off frame.
//
// Bit 7 of byte 0 starts a frame. Bit 7 of bytes 1 to 34 would set lights and the board's rate, which the board
// remembers. Only the frame that with_divider() makes has any of these bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "array/transducer_drive.hpp"
#include "driver/openmpd/board_file.hpp"
#include "driver/openmpd/pins.hpp"

namespace palpa::driver::openmpd {

inline constexpr std::size_t frame_bytes = 2 * transducers;
inline constexpr unsigned phase_steps = 128;
inline constexpr unsigned full_width = 64;
using Frame = std::array<std::uint8_t, frame_bytes>;

/// Silences a board: a start bit and 511 zeros.
inline constexpr Frame all_off_frame = [] {
  Frame frame{};
  frame[0] = 0x80;
  return frame;
}();

/// Makes the board take a frame every `divider` periods of 25 us, 1 to 255.
Frame with_divider(Frame frame, std::uint8_t divider);

/// Encodes for one board.
class Encoder {
 public:
  explicit Encoder(const Calibration& calibration = {}, double lag_periods = 0);

  /// `drive` is of this board's 256 transducers, in layout order. Allocates nothing.
  void encode(std::span<const array::TransducerDrive> drive, Frame& out) const;

 private:
  struct Transducer {
    std::uint8_t pin;
    double offset_steps;  ///< plus half a step, for rounding
  };
  std::array<Transducer, transducers> transducers_;
};

}  // namespace palpa::driver::openmpd
