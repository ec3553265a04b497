// Emulated SonicSurface boards on one serial line: a primary one, and a secondary one that hears what the primary
// repeats. They read bytes as the firmware's state machine does, and say what sounds. If the boards would accept some
// input although no program can have intended it, the input counts as a violation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/emulate/violations.hpp"

namespace palpa::driver::sonicsurface {

class EmulatedBoards {
 public:
  static constexpr std::size_t slots = 256;
  static constexpr int silent = -1;

  EmulatedBoards(std::size_t boards, bool tactile);

  /// The line's speed, as set by the program that opened it. The boards' own speed is 227556 baud; they tolerate 3 %.
  void set_baud(double now_s, double baud);
  void take(double now_s, std::span<const std::uint8_t> bytes);

  /// The phase that a transducer has been sent, in layout order (16 r + c, r from the bottom as seen from the side on
  /// which it emits sound), in 1/32 turns, or `silent`.
  int sounding(std::size_t board, std::size_t transducer) const;
  /// How much later than that it sounds, in periods: an output of each shift register comes one step late, and the
  /// secondary board runs 12.92 us after the primary one.
  double late_periods(std::size_t board, std::size_t transducer) const;
  bool all_silent() const;
  /// Whether nothing would sound after the next swap of the buffers.
  bool all_silent_behind() const;
  std::uint64_t swaps() const { return swaps_; }
  std::uint64_t bytes() const { return bytes_; }
  const emulate::Violations& violations() const { return violations_; }

 private:
  using Buffer = std::array<std::uint8_t, slots>;
  struct Board {
    std::array<Buffer, 2> buffers{};  ///< after power-up all phases are 0: they sound
    std::size_t front = 0, counter = slots;
    bool selected = true;
    std::size_t written = 0;  ///< since `begin`
  };
  void take_byte(std::uint8_t byte);
  void take_phase(Board& board, std::uint8_t byte);

  bool tactile_;
  std::vector<Board> boards_;
  double now_s_ = 0;
  std::uint64_t swaps_ = 0, bytes_ = 0;
  emulate::Violations violations_;
};

}  // namespace palpa::driver::sonicsurface
