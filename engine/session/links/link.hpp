// A link is where drives go: a board, an emulator, a recorder, a stream of foci, nothing. Links are interchangeable by
// name and behave alike; docs/add-a-link.md shows how to write one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

/// What a link is told when it is opened. The referenced values outlive the link.
struct LinkSetting {
  const array::Layout& layout;               ///< as posed in the world
  std::span<const std::string> solid_names;  ///< by solid index
  double slot_s = 1.5e-3;                    ///< one drive lasts that long
  bool foci_move = true;                     ///< from slot to slot; else a plan is one drive and its modulation
  double sound_speed_m_s = 343.21;           ///< for boards that compute phases by themselves
  double ramp_s = 0;                         ///< --ramp: a link that can goes from focus to focus in steps, too
  std::string board_files{};                 ///< folder with the boards' own calibration; empty: none
};

/// What sounds from now on, as a link gets it: enough for a board that plays a pattern by its own clock. What it
/// refers to is valid during the call; nothing of it is copied for a link that needs none of it.
struct PlayedPlan {
  const array::Schedule& schedule;  ///< whose foci when; no voices: silence. Its slot_s is how long a slot lasts
  /// Where its cycle is not listed and there are voices, drives come by send() alone, as they all do for a caller that
  /// only has a schedule.
  Slots slots{};
  std::span<const array::TransducerDrive> drives{};  ///< slots.cycle.length drives, one entry per transducer in each
};

/// All calls come from one thread, the output thread. A link that can fail throws Error: the loop then sends silence,
/// ends and reports it. Whoever plays to a link does so through a SafeLink (session/links/safe_link.hpp), which makes
/// an all-zero drive the last that any link gets, on every path.
class Link {
 public:
  virtual ~Link() = default;

  /// What sounds from now on: once per frame, before its first drive, and without voices when what sounded has expired.
  virtual void plan(const PlayedPlan& plan) = 0;

  /// The drive of slot `slot`, one entry per transducer in layout order, at the slot's time. Called for every slot;
  /// slots that the output thread overslept are skipped, so numbers ascend but may leap.
  virtual void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) = 0;

  /// After the last drive: hands over what is still buffered. Errors here are reported, too.
  virtual void finish() {}

  /// How much of what it was handed has reached its device, counted from its opening on. Asked about once a second and
  /// after finish(), also where that threw. Nothing: it does not count.
  virtual std::optional<Carried> carried() const { return std::nullopt; }
};

/// A kind of link: `name` or `name:ARGUMENT` on the command line.
struct LinkKind {
  std::string name;
  std::string help;  ///< "record:FILE  every drive into a file"
  std::function<std::unique_ptr<Link>(const std::string& argument, const LinkSetting&)> open;
  bool writes_file = false;        ///< the argument is the name of a file that it writes
  bool reads_board_files = false;  ///< it heeds LinkSetting::board_files; open_link() refuses these for others
  /// The built-in layout of the boards that an argument names; "" where none fits.
  std::function<std::string(const std::string& argument)> own_layout{};
  /// The shortest slot in which foci may move from one to the next, for a link that has such a limit. Throws as open().
  std::function<double(const std::string& argument, const array::Layout& layout)> least_moving_slot_s{};
};

/// `null`, `record`, `foci`.
std::vector<LinkKind> builtin_links();

/// Opens "name" or "name:argument". Throws bad_usage with the known names for an unknown one.
std::unique_ptr<Link> open_link(const std::string& spec, std::span<const LinkKind> kinds, const LinkSetting& setting);

/// The layout of the link's own boards; "" where it has none, or nobody knows.
std::string layout_of_link(const std::string& spec, std::span<const LinkKind> kinds);

/// The shortest slot in which foci may move on that link; 0 where any will do.
double least_moving_slot_s(const std::string& spec, std::span<const LinkKind> kinds, const array::Layout& layout);

/// The file that such a link would write; "" where it writes none.
std::string file_of_link(const std::string& spec, std::span<const LinkKind> kinds);

}  // namespace palpa::session
