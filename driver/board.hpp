// A board as its guard plays on it. A guard (driver/guard/) is the one process that has the device open, one for each
// link that drives a board; it calls everything here from one thread, and calls nothing else. Each board has a folder
// here: what it speaks, its Board, its emulator.
//
//   open -> { play | plan | all_off | tend }... -> all_off -> close
//
// Only open() allocates, waits and throws. Afterwards nothing throws, and nothing but close() waits for the device:
// what it does not take at once is kept (the newest; nothing queues) and tend() goes on with it. Nothing allocates but
// the search for a device that is lost, which may also wait for one answer of it, and what libusb does by itself.
//
// A device that fails, disappears or comes back is the board's own affair: it says so once (BoardNotes), takes drives
// as before and drops them, tries again within tend(), makes the device silent before anything else when it is back,
// says that, and plays on. So a loop never ends for a cable.
#pragma once

#include <poll.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/slots.hpp"

namespace palpa::driver {

/// What a board has to say: one line, without its link's name. It reaches the loop's log; what does not fit into the
/// way there is dropped. Neither allocates nor waits. Once per change, not once per drive.
class BoardNotes {
 public:
  virtual ~BoardNotes() = default;
  virtual void warning(std::string_view line) noexcept = 0;  ///< what a person should act on, and that it is over
  virtual void info(std::string_view line) noexcept = 0;     ///< such as the rate that was reached
};

/// What a board is opened for. It goes from the link to the guard's Board as one value.
struct BoardSpec {
  std::string argument;    ///< what follows the colon of `--link openmpd:SERIAL,SERIAL`
  std::string files;       ///< folder with the boards' own calibration (`--board-files`); "": none
  array::Layout layout;    ///< as posed in the world
  double slot_s = 1.5e-3;  ///< one drive lasts that long
  bool foci_move = true;   ///< from slot to slot; else a plan is one drive and its modulation
  double sound_speed_m_s = 343.21;
  double ramp_s = 0;  ///< a change from drive to drive takes so long, where the board can and the slot allows; 0: none
};

/// The slots of a plan on a clock that the loop and its guard share.
struct TimedSlots {
  session::Slots slots;
  double from_s = 0;  ///< when slots.from begins, on CLOCK_MONOTONIC; it may be over by some slots
  double slot_s = 0;  ///< one slot lasts that long

  /// When slots.until begins.
  double until_s() const { return from_s + static_cast<double>(slots.count()) * slot_s; }
};

/// A pattern for a board that plays by its own clock, valid during the call: from slots.from on each slot sounds the
/// drive that its cycle says, until another plan comes. Where the cycle is not listed there is silence, or drives that
/// come by play() alone. See session::PlayedPlan, which this is on the guard's side.
struct BoardPlan : TimedSlots {
  std::span<const array::TransducerDrive> drives{};  ///< slots.cycle.length * transducers
  /// One per drive where each drive is one focus, in the frame of BoardSpec::layout; else none.
  std::span<const Vec3> foci{};
};

/// How many of the drives and plans that sound have come how far, since the board was opened. What a board plays from a
/// plan by its own clock counts drive by drive, too, as long as play() names drives that the plan has.
struct BoardCounts {
  session::Passed submitted;   ///< the transfer to the device was begun
  session::Passed completed;   ///< the device has taken all of it
  std::uint64_t starting = 0;  ///< see session::Carried
};

class Board {
 public:
  /// Closes the device, and does nothing else with it: silence is all_off() and close().
  virtual ~Board() = default;

  /// The drive of slot `slot`, all transducers in layout order, to sound from now until the next. Slots ascend but may
  /// leap. All zero silences at once whatever else waits. Costs at most 0.2 ms.
  virtual void play(std::uint64_t slot, std::span<const array::TransducerDrive> drive) = 0;

  /// Only where its kind says plays_plans. play() goes on coming for every slot: the board takes no notice of drives
  /// that its pattern has at that slot; all-zero ones that the pattern does not have silence it.
  virtual void plan(const BoardPlan&) {}

  /// What silences this board, whatever it was doing: drops what waits, and nothing may sound afterwards until play()
  /// or plan() comes. Costs as little as play().
  virtual void all_off() = 0;

  /// Goes on with what waits for the device. Called when one of watched() is ready, and every 5 ms at least.
  virtual void tend() {}

  /// What to wait on beside the loop: at most 16, asked for before each wait.
  virtual std::span<const pollfd> watched() { return {}; }

  /// After all_off(): waits until it has left for the device, 0.85 s at most. False: nobody knows whether it
  /// did.
  virtual bool close() = 0;

  /// Asked for after every round of calls, and after close(): costs next to nothing.
  virtual BoardCounts counts() const = 0;
};

/// A kind of board: `name:ARGUMENT` is its link on the command line.
struct BoardKind {
  std::string name;
  std::string help;  ///< "openmpd:SERIAL[,SERIAL...]: OpenMPD boards on USB"
  /// Everything that can be refused is refused here, with one line that says what would be right (palpa::Error): no
  /// such device, a layout or a slot that it cannot play. Comes back with the device open and silent.
  /// The notes outlive the board.
  std::function<std::unique_ptr<Board>(const BoardSpec&, BoardNotes&)> open;
  bool plays_plans = false;
  bool reads_files = false;  ///< it heeds BoardSpec::files
  /// The built-in layout of the boards that an argument names, for users who do not say how they stand; "": none fits.
  std::function<std::string(const std::string& argument)> own_layout{};
  /// The shortest slot in which foci may move; empty: any. Throws as open() does.
  std::function<double(const std::string& argument, const array::Layout& layout)> least_moving_slot_s{};
};

/// All that palpa and its guard know.
std::vector<BoardKind> board_kinds();

}  // namespace palpa::driver
