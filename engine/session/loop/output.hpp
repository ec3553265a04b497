// The work of the output thread: a drive for every slot, on time, whatever happens to the frames. Silence has the
// highest priority.
#pragma once

#include <atomic>
#include <cstdint>

#include "array/drive.hpp"
#include "session/clock.hpp"
#include "session/links/safe_link.hpp"
#include "session/loop/run_observer.hpp"
#include "session/newest.hpp"
#include "session/plan/plan.hpp"
#include "session/predict/slot_clock.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct OutputSetting {
  const array::Layout& layout;
  array::DriveOptions drive;
  double slot_s = 1.5e-3;
  double hold_s = 0.1;  ///< a plan sounds at most this long after its frame's capture
  Safety safety;
  SlotClock* slots = nullptr;  ///< if given, it learns when slot 0 begins
};

/// The flags that end the output. The output checks all of them for every slot, so nobody has to forward an external
/// request.
struct Ending {
  const std::atomic<bool>& stop;    ///< the flag of the loop's caller
  std::atomic<bool> over{false};    ///< the flag of the loop itself
  std::atomic<bool> failed{false};  ///< an error: silence at once, without a ramp

  bool asked() const { return stop || over || failed; }
};

/// Plays the newest plan through a SafeLink until the end is requested. Then it goes silent, down the ramp if there is
/// one. Silence comes at once if something failed, or if the link or anything else throws (the error is rethrown
/// afterwards). The slot counter starts at 0 and never restarts. Slots that the thread missed by a whole slot are
/// skipped. However long a slot is, its sound ends when its plan expires or the end is requested, and a ramp does not
/// exceed its time. By the real clock, the thread asks for real-time scheduling. Computes the drives that plans do not
/// list; otherwise, it waits only for the clock and the link. Of `observer`, calls sent().
void play(Link& link, Newest<Plan>& plans, const OutputSetting& setting, const Clock& clock, const Ending& ending,
          OutputStats& stats, RunObserver& observer = no_observer);

/// Scratch memory for the drive of a slot that the plan does not list; kept from slot to slot.
struct SlotScratch {
  array::Drive drive;
  std::vector<array::SlotFocus> foci;
  array::DriveScratch work;
  /// Reserves all the memory that a slot can need.
  void reserve(const OutputSetting& setting);
};

/// The drive of one slot: the plan's drive with its modulation and course, or all zero if the plan has expired at
/// `now_s` or touches nothing. If it must be computed, it is in `scratch`.
std::span<const array::TransducerDrive> drive_of_slot(const Plan& plan, std::uint64_t slot, double now_s,
                                                      const OutputSetting& setting, SlotScratch& scratch);

}  // namespace palpa::session
