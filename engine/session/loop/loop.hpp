// The live loop, for any planner: capture, compute and output, each on its own thread. The newest frame wins; drives
// leave on time even when a frame is late; every way out ends in silence. Session::run is it for a session.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "sensing/depth_source.hpp"
#include "session/links/link.hpp"
#include "session/loop/output.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct LoopSetting {
  OutputSetting output;
  std::uint64_t frames = 0;  ///< stop after that many captured frames; 0: at the source's end
  /// Off: a frame that comes while another waits replaces it, and so does a plan. On: each waits for the next thread,
  /// so every frame is looked at and every plan is played.
  bool every_frame = false;
  /// Where frames are late, and all has been shed that can be, they may sound for longer than the hold, up to
  /// longest_auto_hold_s.
  bool lengthens_hold = false;
};

/// What others may look at while the loop runs. They must not throw anything but Error; `planned` must not linger.
struct LoopObservers {
  /// Capture thread: a frame with that number has come, and will be planned or replaced by a newer one. Must not
  /// linger.
  std::function<void(std::uint64_t sequence)> arrived;
  /// On a thread of its own, so that a slow disk delays no touch: every frame, e.g. to be written down. Frames that
  /// come while it is busy are left out, all but the newest (never with every_frame), and counted as `unrecorded`.
  std::function<void(const sensing::FrameSet&)> record;
  std::function<void(const FrameReport&, const Plan&)> planned;  ///< compute thread (the caller's)
  /// Compute thread, once when no frame has come for the hold after one was planned. Never with every_frame, whose
  /// frames wait for the loop.
  std::function<void()> expired;
};

/// Runs until the source ends, `setting.frames` are done, `stop` becomes true or something fails; an Error of any
/// thread ends all of them and is thrown here, after the link has got silence. Silence waits for nobody but the link:
/// the output thread sees itself that `stop` is true, whatever the others are doing, and what they log is written by a
/// thread of its own (log::Relay). A source, a device, a recorder or an observer that never comes back keeps this
/// function from returning, nothing more. Where anything fails `stop` becomes
/// true, so that nobody waits on for a reader. `stats` is filled as the loop goes and complete on every path; `planner`
/// is not busy afterwards.
void run_loop(sensing::DepthSource& source, Planner& planner, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const LoopObservers& observers, LoopStats& stats);

}  // namespace palpa::session
