// A board as its guard uses it. A guard (driver/guard/) is the only process that has the device open. There is one
// guard for each link that drives a board. It calls the functions below from one thread, and no other functions of a
// board. Each board has a folder beside this file with its protocol, its Board and, in emulated/, its emulator.
//
//   open -> { play | plan | all_off | tend }... -> all_off -> close
//
// Only BoardKind::open allocates, waits and throws. Afterwards nothing throws, and only close() waits for the device.
// Data that the device does not take at once is kept (only the newest, without a queue), and tend() continues with it.
// Nothing allocates, with two exceptions: the search for a lost device, which may also wait for one answer from it, and
// libusb's own allocations.
//
// The board itself handles a device that fails, disappears or comes back. It reports this once (BoardNotes), takes
// drives as before and drops them, and tries again within tend(). When the device is back, it silences the device
// before anything else, reports that, and plays on. A loop therefore never ends because of a cable.
#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "array/transducer_drive.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/slots.hpp"

namespace palpa::driver {

/// What a board reports: one line, without its link's name. The line reaches the loop's log; if it does not fit into
/// the channel, it is dropped. The functions neither allocate nor wait. Call them once per change, not once per drive.
class BoardNotes {
 public:
  virtual ~BoardNotes() = default;
  virtual void warning(std::string_view line) noexcept = 0;  ///< a problem that a person should act on, and its end
  virtual void info(std::string_view line) noexcept = 0;     ///< such as the rate that was reached
  virtual void waits(std::string_view line) noexcept = 0;    ///< why opening is slow, written at once
};

/// How a board is to be opened. It goes from the link to the guard's Board as one value.
struct BoardSpec {
  std::string argument;    ///< what follows the colon of `--link openmpd:SERIAL,SERIAL`
  std::string files;       ///< folder with the boards' own calibration (`--board-files`); "": none
  array::Layout layout;    ///< as posed in the world
  double slot_s = 1.5e-3;  ///< the time that one drive lasts
  bool foci_move = true;   ///< from slot to slot; else a plan is one drive and its modulation
  double sound_speed_m_s = 343.21;
  double ramp_s = 0;   ///< --ramp
  bool steps = false;  ///< a change from drive to drive takes the slot, in even steps, if the board and its cable can
  bool nulls = false;  ///< drives are silent at places, and what lies between two drives is not: changes are jumps
};

/// How many boards of a type, of `each` transducers, the layout consists of; 0 if it has anything else.
inline std::size_t boards_of_type(const array::Layout& layout, std::string_view type, std::size_t each) {
  std::size_t boards = 0;
  for (const array::Board& board : layout.boards)
    boards += board.type == type && board.count == each && board.first == boards * each ? 1 : 0;
  return boards * each == layout.transducers.size() ? boards : 0;
}

/// The slots of a plan on a clock that the loop and its guard share.
struct TimedSlots {
  session::Slots slots;
  double from_s = 0;  ///< when slots.from begins, on CLOCK_MONOTONIC; may be some slots ago
  double slot_s = 0;  ///< the time that one slot lasts

  /// When slots.until begins.
  double until_s() const { return from_s + static_cast<double>(slots.count()) * slot_s; }
};

/// A plan for a board that plays by its own clock. Valid during the call. From slots.from on, slots.cycle.plays says
/// what sounds: the listed drives, silence, or what play() brings. It holds until the next plan, or until slots.until.
/// It is session::PlayedPlan for the guard.
struct BoardPlan : TimedSlots {
  std::span<const array::TransducerDrive> drives{};  ///< slots.cycle.length * transducers
  /// The focus of each drive, in the frame of BoardSpec::layout, if the phases of each drive are those of the distances
  /// to its focus; else empty. Amplitudes may be anything.
  std::span<const Vec3> foci{};
};

/// How many drives and plans that sound have reached each stage since the board was opened. Drives that a board plays
/// from a plan by its own clock also count one by one, as long as play() gives drives that the plan has.
struct BoardCounts {
  session::Passed submitted;   ///< the transfer to the device was begun
  session::Passed completed;   ///< the device has taken all of it
  std::uint64_t starting = 0;  ///< see session::Carried, also for the next one
  bool out_of_reach = false;
  std::optional<std::uint64_t> late{};
};

class Board {
 public:
  /// Only closes the device. all_off() and close() silence it.
  virtual ~Board() = default;

  /// Plays the drive of slot `slot`, all transducers in layout order, from now until the next. Slots ascend but may
  /// skip. An all-zero drive silences at once, whatever else waits. Takes at most 0.2 ms.
  virtual void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) = 0;

  /// Called only if its kind says plays_plans. play() is still called for every slot, except for those in which the
  /// pattern pauses. The board ignores drives that its pattern has at that slot. A plan of nothing silences it.
  virtual void plan(const BoardPlan&) {}

  /// Silences this board, whatever it was doing. It drops what waits, and nothing may sound afterwards until play() or
  /// plan() comes. Takes as little time as play().
  virtual void all_off() = 0;

  /// Continues with what waits for the device. Called when one of watched() is ready, and at least every 5 ms.
  virtual void tend() {}

  /// The descriptors on which the guard waits besides the loop, at most 16. The guard asks for them before each wait.
  virtual std::span<const pollfd> watched() { return {}; }

  /// Called after all_off(): waits until the silence has left for the device, 0.85 s at most. Returns false if it is
  /// not known whether it has.
  virtual bool close() = 0;

  /// Called after every round of calls and after close(), so it must cost next to nothing.
  virtual BoardCounts counts() const = 0;
};

/// A kind of board: `name:ARGUMENT` is its link on the command line.
struct BoardKind {
  std::string name;
  std::string help;  ///< "openmpd:SERIAL[,SERIAL...]: OpenMPD boards on USB"
  /// Everything that can be refused is refused here, with one line that says what would be right (palpa::Error): no
  /// such device, or a layout or a slot that it cannot play. Returns with the device open and silent. The notes must
  /// outlive the board.
  std::function<std::unique_ptr<Board>(const BoardSpec&, BoardNotes&)> open;
  bool plays_plans = false;  ///< plan() is called; otherwise, plans list no drives while foci move with their fingers
  bool reads_files = false;  ///< it uses BoardSpec::files
  /// The built-in layout of the boards that an argument names, for users who give no layout; "": none fits.
  std::function<std::string(const std::string& argument)> own_layout{};
  /// The shortest slot in which foci may move; empty: any. Throws as open() does.
  std::function<double(const std::string& argument, const array::Layout& layout)> least_moving_slot_s{};
  bool takes_steps = false;  ///< it uses BoardSpec::steps
  /// What its files multiply the amplitude of each transducer by (Layout::factors). Drives that it gets have that
  /// already. Empty: nothing. Throws as open() does.
  std::function<std::vector<float>(const BoardSpec&)> factors{};
  /// If plays_plans: the shortest slot of drives that no plan lists. Empty: no limit.
  std::function<double(const array::Layout& layout)> single_drive_s{};
};

/// All kinds that palpa and its guard know.
std::vector<BoardKind> board_kinds();

}  // namespace palpa::driver
