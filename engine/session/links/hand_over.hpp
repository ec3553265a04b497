// How far the drives came that left the loop: counted at each hand-over on their way to the device, so that a run can
// say what reached the wire, and not only what it sent.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "array/drive.hpp"

namespace palpa::session {

/// Whether anything is heard of that drive.
inline bool sounds(std::span<const array::TransducerDrive> drive) {
  return std::any_of(drive.begin(), drive.end(), [](const array::TransducerDrive& t) { return t.amplitude != 0; });
}

/// What has passed one hand-over so far. Silence is not counted: boards leave it out where they are silent already.
struct Passed {
  std::uint64_t drives = 0;  ///< drives in which at least one transducer sounds
  std::uint64_t plans = 0;   ///< plans with at least one finger, of boards that play them
};

/// What a link knows of what it was handed.
struct Carried {
  /// Taken by whoever holds the board; nothing where the link is no board.
  std::optional<Passed> guard;
  /// The transfer to the device was begun. A drive that a board plays from a plan counts when that plan was sent.
  Passed submitted;
  /// The device has all of it. Of a link that is no board: written, or sent as a datagram.
  Passed completed;
  /// Drives that sounded while the first plan of a touch was on its way, within the time that the board's line needs
  /// for it. They are no loss: no board can play a plan before it is there.
  std::uint64_t starting = 0;
};

/// All hand-overs of a run.
struct HandOver {
  Passed loop;                    ///< handed to the link
  std::optional<Carried> behind;  ///< what became of it there; nothing where the link does not count

  /// Drives that left the loop and never reached the device; 0 where nobody knows.
  std::uint64_t lost() const;
  /// How many may be lost without a word: 8, since silence and a stop overtake what is on its way, and 2 % of all,
  /// which an idle machine stays well below.
  std::uint64_t normal() const { return 8 + loop.drives / 50; }
  bool unusual() const { return lost() > normal(); }
};

/// How many drives passed each hand-over, as part of a line.
std::string to_text(const HandOver& counts);

/// Warns once, as soon as more is lost than normal.
class HandOverWatch {
 public:
  /// Looks at what is known by now.
  void look(const HandOver& counts);

 private:
  bool warned_ = false;
};

}  // namespace palpa::session
