// OpenMPD boards as one array: `openmpd:SERIAL[,SERIAL...]`, the serial numbers in the order of the layout's boards. If
// several boards have the same serial number: SERIAL@BUS-PORT.
//
// Each board gets one frame per slot, and all boards get the same number of frames: a drive waits until every board can
// take a frame. Silence does not wait for a board that takes nothing. Each board gets its all-off frame as soon as it
// can take one, and no drive follows before all boards have this frame. The boards take a frame every `divider`
// periods, at most half a slot, so that their buffers stay empty and silence sounds at once. The boards' own cable
// keeps their carriers at one frequency, and one of them (its switch MS_SELECT) is the master of all. No program can
// see or set that. Others run later than the master. A board's own file may contain this lag, because it was measured;
// a board without a file gets its phases earlier by the lag of its firmware's source. Both need the master to be the
// first board. With `lag=`, all but the first get that lag instead.
//
// With steps, a drive is several frames, in even steps from the drive before: phases by the shorter way round, and
// amplitudes. They take the slot except for its last frame, and there are as many as the boards take and as chip and
// bus can carry. A transducer that was off takes its new phase, and one that goes off keeps its old phase. The boards
// pace the frames. Silence waits for those that a board still has, so their queue, with what is on its way, never holds
// more than a slot, nor more than most_queued frames: a drive that comes late leaves out its first steps, and never its
// last frame, which waits instead. Without steps, a drive is one frame, and with a ramp as many as half a slot has, at
// most 8.
//
// If a board falls out of step or is gone, all boards are silenced and resynchronised. The array plays on when all are
// in step again, slightly more than a second after the last board is back. A board that waits for others gets zeros,
// which are not a frame. If nothing is played, an all-off frame is sent twice a second, because a board clears its
// buffer every second in which it got nothing, and might cut the next frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "driver/board.hpp"
#include "driver/clock.hpp"
#include "driver/openmpd/connection.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/usb/device.hpp"

namespace palpa::driver::openmpd {

/// The argument of a link: "A,B@1-4,lag=0.5".
struct Boards {
  std::vector<Address> addresses;
  std::optional<double> lag;  ///< of all but the first, in periods
};
/// Throws bad_usage for an empty name, for a board named twice, and as take_lag() does.
Boards parse_boards(std::string argument);
/// The factors that the boards' files have for the amplitudes of their transducers, in the layout's order; empty if all
/// are 1. Throws as read_board_files() and parse_boards().
std::vector<float> factors_of(const BoardSpec& spec);
/// How many periods of 25 us a board lets pass between frames, for slots of that length: 4, which is the boards' value
/// at power-up, or fewer. Throws bad_usage if half a slot is shorter than a period.
std::uint8_t divider_for(double slot_s);

class OpenMpdBoard final : public Board {
 public:
  /// Opens all boards, and returns when they are in step and silent, after a good second. Throws failure(), bad_usage
  /// or bad_input for everything that can be refused. Notes, transport and clock must outlive this object.
  OpenMpdBoard(const BoardSpec& spec, BoardNotes& notes, usb::Transport& transport, Clock& clock);

  void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) override;
  void all_off() override;
  void tend() override;
  bool close() override;
  BoardCounts counts() const override;
  std::span<const pollfd> watched() override;

  bool in_step() const;
  const std::vector<std::unique_ptr<Connection>>& connections() const { return wires_; }

 private:
  static constexpr double quiet_s = 0.5;  ///< after this time, an all-off frame is sent

  /// Frames that a board holds at most when silence comes, which then waits 1.5 ms for them.
  static constexpr std::size_t most_queued = Connection::most_frames + 1;

  /// How many frames a drive may consist of, and the boards of the fullest bus.
  struct Bandwidth {
    std::size_t frames = 1, boards_of_bus = 1;
  };
  Bandwidth check_bandwidth(double slot_s) const;
  void choose_steps(const BoardSpec& spec, double frame_s);
  void tend_wires(bool may_ask = true);
  void send_next();
  void begin_silence();
  std::size_t room() const;
  void send_steps(std::size_t board, std::size_t count);
  bool send_silences();
  bool healthy_wire_flies() const;
  void tell();

  BoardNotes& notes_;
  Clock& clock_;
  std::vector<std::unique_ptr<Connection>> wires_;
  std::vector<Encoder> encoders_;
  std::vector<Frame> next_;  ///< by board
  bool waits_ = false;       ///< next_ has not been sent
  std::size_t steps_ = 1;    ///< frames of a drive
  std::size_t queue_ = 0;    ///< frames that a board may hold; 0: as many as come
  std::vector<pollfd> watched_;
  array::Drive newest_, sounding_;      ///< with several: what next_ was made of, and what was sent last
  std::vector<std::uint8_t> silences_;  ///< by board: an all-off frame must still be sent, before anything else
  std::size_t asker_ = 0;               ///< the wire whose turn it is to ask its device
  bool silent_ = true;                  ///< what was sent last is the all-off frame
  double sent_s_ = 0;
  bool troubled_ = false;
  double troubled_s_ = 0;
};

/// `openmpd`, on this machine's USB and this user's emulators.
BoardKind board_kind();

}  // namespace palpa::driver::openmpd
