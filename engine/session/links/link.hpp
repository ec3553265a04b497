// A link is the destination of drives: a board, an emulator, a recorder, a stream of foci, or nothing. Links are
// selected by name and behave alike; docs/add-a-link.md shows how to write one.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"
#include "session/links/hand_over.hpp"
#include "session/links/slots.hpp"

namespace palpa::session {

/// The values a link gets when it is opened. The referenced values must outlive the link.
struct LinkSetting {
  const array::Layout& layout;               ///< as posed in the world
  std::span<const std::string> solid_names;  ///< by solid index
  double slot_s = 1.5e-3;                    ///< duration of one drive
  bool foci_move = true;                     ///< from slot to slot; otherwise, a plan is one drive and its modulation
  double sound_speed_m_s = 343.21;           ///< for boards that compute phases themselves
  double ramp_s = 0;                         ///< --ramp, for a link that moves from drive to drive in steps itself
  bool steps = true;          ///< --steps: a link that supports it does so during the whole slot, by the shorter way
  std::string board_files{};  ///< folder with the boards' own calibration; empty: none
  /// The phases of a drive of one focus are those of its distances at the layout's frequency, which such boards
  /// compute, too. False: those of another frequency, of another transfer than the free field, with nulls, or of the
  /// caller's own solver.
  bool free_field = true;
  bool nulls = false;  ///< drives are silent at places; a link that sends foci and no drives refuses this
};

/// The sound from now on, in the form that a link gets. It is complete enough for a board that plays a pattern by its
/// own clock. The referenced data is valid during the call only. Nothing is copied for a link that does not need it.
struct PlayedPlan {
  const array::Schedule& schedule;  ///< when each focus plays; no voices: silence. Its slot_s is the length of a slot
  Slots slots{};                    ///< unless they play a pattern, drives come only through send()
  std::span<const array::TransducerDrive> drives{};  ///< slots.cycle.length drives, each with one entry per transducer
  std::span<const Vec3> foci{};                      ///< the focus of each drive, if each has exactly one; else empty
};

/// All calls come from one thread, the output thread. If a link fails, it throws Error. The loop then sends silence,
/// ends and reports the error. Callers must play to a link through a SafeLink (session/links/safe_link.hpp). SafeLink
/// ensures that the last drive of any link is all-zero, however the run ends.
class Link {
 public:
  virtual ~Link() = default;

  /// Announces the sound from now on. Called once per frame, before its first drive, and without voices when the last
  /// sound has expired.
  virtual void plan(const PlayedPlan& plan) = 0;

  /// The drive of slot `slot`, one entry per transducer in layout order, at the slot's time. Called for every slot;
  /// slots that the output thread missed are skipped, so numbers ascend, possibly with gaps.
  virtual void send(std::uint64_t slot, std::span<const array::TransducerDrive> drive) = 0;

  /// The same for the drive that the last plan has at that slot. Where a link plays plans by its own clock, an all-zero
  /// one is a pause of the pattern and not its end.
  virtual void send_planned(std::uint64_t slot, std::span<const array::TransducerDrive> drive) { send(slot, drive); }

  /// Whether it plays the listed drives of plans by its own clock. Other links may get plans whose drives are not
  /// listed.
  virtual bool plays_plans() const { return false; }

  /// The layout whose boards play the drives, with the factors of their transducers. SafeLink then rounds amplitudes to
  /// those that the boards have (array/layouts/board_play.hpp): drives and plans have what the wire is to carry. Null:
  /// drives are passed on as they are. Must not change.
  virtual const array::Layout* boards() const { return nullptr; }

  /// Whether drives are played when they arrive. The process is then kept in memory during a run (KeptInMemory). False:
  /// they go nowhere, or into a file of results. Must not change.
  virtual bool plays() const { return true; }

  /// Called after the last drive; flushes buffered data. Errors here are also reported.
  virtual void finish() {}

  /// How many of the given drives have reached the device, counted from its opening. Called about once a second and
  /// after finish(), even if finish() threw. Empty: the link does not count.
  virtual std::optional<Carried> carried() const { return std::nullopt; }
};

/// A kind of link: `name` or `name:ARGUMENT` on the command line.
struct LinkKind {
  std::string name;
  std::string help;  ///< "record:FILE  every drive into a file"
  std::function<std::unique_ptr<Link>(const std::string& argument, const LinkSetting&)> open;
  bool writes_file = false;  ///< the argument is the name of a file that the link writes
  /// the link uses LinkSetting::board_files; open_link() refuses board files for other links
  bool reads_board_files = false;
  /// The built-in layout of the boards that an argument names; "" if none fits.
  std::function<std::string(const std::string& argument)> own_layout{};
  /// The shortest slot in which the focus may change, for a link with such a limit. Throws as open().
  std::function<double(const std::string& argument, const array::Layout& layout)> least_moving_slot_s{};
  bool plays_plans = false;  ///< as Link::plays_plans()
  bool takes_steps = false;  ///< the link uses LinkSetting::steps
  /// If plays_plans: the shortest slot of drives that no plan lists. Empty: no limit.
  std::function<double(const array::Layout& layout)> single_drive_s{};
};

/// `null`, `record`, `foci`.
std::vector<LinkKind> builtin_links();

/// Call before outputs are opened. `folder` has the boards' own files; "": none. The guard, another process, reads
/// them, so this function remembers them as inputs. Throws bad_usage for a link that reads no such files, and for an
/// output among them. open_link() does the same.
void check_board_files(const std::string& spec, std::span<const LinkKind> kinds, const std::string& folder);

/// Opens "name" or "name:argument". Throws bad_usage with the known names for an unknown one.
std::unique_ptr<Link> open_link(const std::string& spec, std::span<const LinkKind> kinds, const LinkSetting& setting);

/// The layout of the link's own boards; "" if there is none or it is unknown.
std::string layout_of_link(const std::string& spec, std::span<const LinkKind> kinds);

/// The shortest slot in which foci may move on that link; 0 if there is no limit.
double least_moving_slot_s(const std::string& spec, std::span<const LinkKind> kinds, const array::Layout& layout);

/// Throws bad_usage for a link that takes no steps.
void check_takes_steps(const std::string& spec, std::span<const LinkKind> kinds);

/// The file that such a link would write; "" if it writes none.
std::string file_of_link(const std::string& spec, std::span<const LinkKind> kinds);

}  // namespace palpa::session
