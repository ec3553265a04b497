// Counts drives at each hand-over on their way from the loop to the device. A run can then report how many drives
// reached the wire, not only how many it sent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "array/transducer_drive.hpp"
#include "base/system/real_time.hpp"

namespace palpa::session {

/// Whether that drive makes any sound.
inline bool sounds(std::span<const array::TransducerDrive> drive) {
  return std::any_of(drive.begin(), drive.end(), [](const array::TransducerDrive& t) { return t.amplitude != 0; });
}

/// The numbers of drives and plans that have passed one hand-over so far. Silence is not counted, because boards skip
/// it if they are silent already.
struct Passed {
  std::uint64_t drives = 0;  ///< drives in which at least one transducer sounds
  std::uint64_t plans = 0;   ///< plans with at least one finger, for boards that play plans
};

/// A link's counts of the drives it was given.
struct Carried {
  /// Taken by the process that holds the board; empty if the link is not a board.
  std::optional<Passed> guard;
  /// Drives whose transfer to the device has begun. A drive that a board plays from a plan counts once that plan is
  /// sent.
  Passed submitted;
  /// Drives that are completely on the device. For a link that is not a board: written, or sent as a datagram.
  Passed completed;
  /// Drives that sounded while the first plan of a touch was being transferred, within the time that the board's line
  /// needs for it. They do not count as lost, because no board can play a plan before it has arrived.
  std::uint64_t starting = 0;
  /// The device takes nothing at the moment, for example because it was unplugged. It plays on what it has.
  bool out_of_reach = false;
  /// Frames that a device carried out after their time, as it says itself after the last drive. Empty: it does not say.
  std::optional<std::uint64_t> late;
  /// How the system schedules the process that holds the board.
  Scheduling guard_scheduling = Scheduling::unknown;
};

/// All hand-overs of a run.
struct HandOver {
  Passed loop;                    ///< handed to the link
  std::optional<Carried> behind;  ///< the counts of the link; empty if the link does not count

  /// Drives that left the loop and never reached the device; 0 if unknown.
  std::uint64_t lost() const;
  /// The number of lost drives up to which no warning is given. It is 8, because silence and a stop overtake drives
  /// that are on their way, plus 2 % of all drives. An idle machine stays well below that.
  std::uint64_t normal() const { return 8 + loop.drives / 50; }
  bool unusual() const { return lost() > normal(); }
};

/// The number of drives that passed each hand-over, as part of a line.
std::string to_text(const HandOver& counts);

/// Warns once if more drives are lost than normal, and says what helps. Drives that were lost while none arrived have
/// another remedy than those that were lost between others, so it waits for one more look before it judges.
class HandOverWatch {
 public:
  /// Checks the current counts, about once a second.
  void look(const HandOver& counts) { look(counts, false); }
  /// The same for the last counts of a run.
  void end(const HandOver& counts) { look(counts, true); }

 private:
  void look(const HandOver& counts, bool last);

  bool warned_ = false;
  std::uint64_t lost_ = 0, completed_ = 0;  ///< at the last look
  std::uint64_t newest_ = 0;                ///< lost between the last two looks
  std::uint64_t stuck_ = 0;                 ///< lost while none arrived, and just before
};

}  // namespace palpa::session
