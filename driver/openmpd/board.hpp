// OpenMPD boards as one array: `openmpd:SERIAL[,SERIAL...]`, the serial numbers in the order of the layout's boards.
// Where several boards have one serial number: SERIAL@BUS-PORT.
//
// One frame per slot and board, all boards the same number of frames: a drive waits until all of them take one. Silence
// does not wait for a board that takes nothing: each gets its all-off frame as soon as it takes one, and no drive
// follows before all have it. The boards take a frame every `divider` periods,
// at most half a slot, so that their buffers stay empty and silence sounds at once. Their carriers are in phase by
// their own cable, one of them (its switch MS_SELECT) being the master of all; no program can see or set that.
//
// With a ramp a drive is several frames, in even steps from the one before: in half a slot at most, as many as the
// boards take and chip and bus carry. What was off takes the phases that come, what goes off keeps its own.
//
// Where a board falls out of step, or is gone, all boards are silenced and resynchronised, and the array plays on when
// all are in step again, a good second after the last is back; one that waits for others gets zeros, which are no
// frame. Where nothing is played an all-off frame goes out twice
// a second, since a board clears its buffer every second in which it got nothing, and might cut the next frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "driver/board.hpp"
#include "driver/clock.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/openmpd/wire.hpp"
#include "driver/usb/device.hpp"

namespace palpa::driver::openmpd {

/// Of one high-speed bus, and of one FT232H, as far as anybody has measured.
inline constexpr double bus_bytes_per_s = 40e6, chip_bytes_per_s = 8e6;

/// "A,B@1-4": throws bad_usage for an empty name, or for a board named twice.
std::vector<Address> parse_addresses(const std::string& argument);
/// How many periods of 25 us a board lets pass between frames, for slots of that length: 4, as boards have it when they
/// are switched on, or fewer. Throws bad_usage where half a slot is shorter than a period.
std::uint8_t divider_for(double slot_s);

class OpenMpdBoard final : public Board {
 public:
  /// Opens all of them; comes back when they are in step and silent, after a good second. Throws failure(), bad_usage
  /// or bad_input for everything that can be refused. Notes, transport and clock outlive it.
  OpenMpdBoard(const BoardSpec& spec, BoardNotes& notes, usb::Transport& transport, Clock& clock);

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override;
  void all_off() override;
  void tend() override;
  bool close() override;
  BoardCounts counts() const override;

  bool in_step() const;
  const std::vector<std::unique_ptr<Wire>>& wires() const { return wires_; }

 private:
  static constexpr double quiet_s = 0.5;  ///< then an all-off frame goes out

  /// How many frames a drive may be.
  std::size_t check_bandwidth(double slot_s) const;
  void tend_wires(bool may_ask = true);
  void send_next();
  void begin_silence();
  void send_steps(std::size_t board);
  bool send_silences();
  bool healthy_wire_flies() const;
  void tell();

  BoardNotes& notes_;
  Clock& clock_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::vector<Encoder> encoders_;
  std::vector<Frame> next_;             ///< by board
  bool waits_ = false;                  ///< next_ has not been sent
  std::size_t steps_ = 1;               ///< frames of a drive
  array::Drive newest_, sounding_;      ///< with more than one: what next_ was made of, and what was sent last
  std::vector<std::uint8_t> silences_;  ///< by board: an all-off frame is still to be sent, before anything else
  std::size_t asker_ = 0;               ///< the wire whose turn it is to ask its device
  bool silent_ = true;                  ///< what was sent last is the all-off frame
  double sent_s_ = 0;
  std::uint64_t faint_ = 0;  ///< drives that sound less than a board's first step: its silence is what they are
  bool troubled_ = false;
  double troubled_s_ = 0;
};

/// `openmpd`, on this machine's USB and this user's emulators.
BoardKind board_kind();

}  // namespace palpa::driver::openmpd
