// The emulated logic behind the FT232H on an OpenMPD board: how it takes the board's frames, with its timing, its
// buffer and its pitfalls. It knows only the wire, and nothing of the encoder.
//
//   bytes -> buffer of 16384 -> a block of 512 every `divider` periods -> parser -> what sounds from the next period on
//
//  - at 14336 bytes it stops taking more;
//  - if it was idle, it takes the next block as soon as that is whole; then it counts `divider` periods of 25 us;
//  - the parser waits for a byte with bit 7, takes 511 more, and loses a byte that comes in the same clock as the swap:
//    one lost byte glues two frames together, and then every other frame is lost, until it is resynchronised;
//  - bit 7 of bytes 1 to 34 sets lights and the divider, which persist; those of the other bytes mean nothing;
//  - fewer than 512 bytes for a second: the buffer is cleared;
//  - for the first second after power-up it reads nothing, then it plays an all-off frame;
//  - there is no watchdog: the last frame sounds on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>

#include "driver/emulate/violations.hpp"

namespace palpa::driver::openmpd {

/// One pin: it is on during counts [phase, phase + width) of the 128 of a period.
struct Pulse {
  std::uint8_t phase = 0, width = 0;
  bool operator==(const Pulse&) const = default;
};
using Pulses = std::array<Pulse, 256>;  ///< by pin

class Fpga {
 public:
  static constexpr std::int64_t period_ns = 25000;
  static constexpr std::size_t buffer_bytes = 16384, stop_bytes = 14336, block_bytes = 512;

  /// Powered up at time 0. The violations must outlive this object.
  explicit Fpga(emulate::Violations& violations);

  /// What sounds from `time_s` on. Called once per frame shown, in order.
  using Shown = std::function<void(double time_s, const Pulses&)>;
  void on_shown(Shown shown) { shown_ = std::move(shown); }

  /// Takes bytes from the front of `bytes`, and returns how many.
  std::size_t take(double now_s, std::span<const std::uint8_t> bytes);
  void advance(double now_s);

  /// As after a purge. From here on, bytes that belong to no frame are not a violation, until a frame fills a block at
  /// least a second later. Meanwhile, only what was left in the buffer may sound.
  void begin_resync(double now_s);

  const Pulses& pulses() const { return front_; }
  bool sounds() const;
  /// Whether something that would sound waits in its buffer or in the next frame.
  bool sounds_behind() const;
  unsigned divider() const { return divider_ == 0 ? 256 : divider_; }
  std::uint64_t frames() const { return frames_; }  ///< shown since power-up
  /// Frames shown since it was last brought into step. Boards of one array get equal numbers of these.
  std::uint64_t frames_in_step() const { return frames_in_step_; }
  std::uint64_t dividers_set() const { return dividers_set_; }
  std::size_t buffered() const { return used_; }
  std::size_t most_buffered() const { return most_used_; }  ///< at any time
  std::uint64_t clears() const { return clears_; }          ///< of the buffer with something in it
  /// The time at which the frame that sounds was shown, in seconds; negative if no frame was shown.
  double shown_s() const { return shown_s_; }

 private:
  enum class Reader { starting, idle, counting };

  void step_to(std::int64_t now_ns);
  void read_block(std::int64_t now_ns);
  void parse(std::uint8_t byte, std::int64_t now_ns);
  void finish_frame(std::int64_t now_ns);
  void violate(std::int64_t now_ns, const char* what);

  emulate::Violations& violations_;
  Shown shown_;
  std::int64_t now_ns_ = 0;

  std::array<std::uint8_t, buffer_bytes> buffer_{};
  std::size_t first_ = 0, used_ = 0, most_used_ = 0;
  std::int64_t below_since_ns_ = 0;  ///< when the buffer last began to have fewer bytes than a block
  std::uint64_t clears_ = 0;

  Reader reader_ = Reader::starting;
  std::int64_t next_edge_ns_ = 0;  ///< when the next block may be read
  std::uint8_t divider_ = 4, divider_bits_ = 0;
  std::uint64_t dividers_set_ = 0;

  std::size_t at_ = 0;     ///< number of the frame's next byte; 0: waits for a frame to start
  bool swapping_ = false;  ///< the next byte of this block is lost
  bool resyncing_ = true;
  std::int64_t resync_from_ns_ = 0;
  unsigned sounding_frames_ = 0;  ///< of this resynchronisation, without what was left in the buffer
  std::size_t left_ = 0;          ///< bytes in the buffer from before the resynchronisation
  Pulses back_{}, front_{};
  std::uint64_t frames_ = 0, frames_in_step_ = 0;
  double shown_s_ = -1;
};

}  // namespace palpa::driver::openmpd
