// The output thread's work: a drive for every slot, on time, whatever the frames do; silence before everything else.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "array/drive.hpp"
#include "session/clock.hpp"
#include "session/links/plan.hpp"
#include "session/links/safe_link.hpp"
#include "session/newest.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct OutputSetting {
  const array::Layout& layout;
  array::DriveOptions drive;
  double slot_s = 1.5e-3;
  double hold_s = 0.1;  ///< a plan sounds at most that long after its frame's capture
  Safety safety;
};

/// What ends the output. It looks at all of it for every slot: nobody has to pass on what is asked from outside.
struct Ending {
  const std::atomic<bool>& stop;    ///< of whoever runs the loop
  std::atomic<bool> over{false};    ///< the loop's own
  std::atomic<bool> failed{false};  ///< something broke: silence at once, without a ramp

  bool asked() const { return stop || over || failed; }
};

/// Plays the newest plan until the end is asked for, through a SafeLink: then silence, down the ramp if there is one;
/// at once where something failed, and where the link or anything else throws (the error is passed on afterwards). The
/// slot counter starts at 0 and never restarts; slots that the thread overslept by a whole slot are left out. However
/// long a slot is, its sound ends when its plan expires or the end is asked for, and a ramp lasts no longer than it
/// should. It waits for the clock and the link, and for nothing else. `sent`: see RunOptions.
void play(Link& link, Newest<Plan>& plans, const OutputSetting& setting, const Clock& clock, const Ending& ending,
          OutputStats& stats, const std::function<void(bool sounds)>& sent = {});

/// Where the drive of a slot is computed that a plan does not hold; kept from slot to slot.
struct SlotScratch {
  array::Drive drive;
  std::vector<array::SlotFocus> foci;
  array::DriveScratch work;
  /// Gives it all the room that a slot can need.
  void reserve(const OutputSetting& setting);
};

/// The drive of one slot, into `scratch` where it has to be computed: plan's drive, its modulation, or all zero where
/// the plan has expired at `now_s` or touches nothing.
std::span<const array::TransducerDrive> drive_of_slot(const Plan& plan, std::uint64_t slot, double now_s,
                                                      const OutputSetting& setting, SlotScratch& scratch);

}  // namespace palpa::session
