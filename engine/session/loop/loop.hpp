// The live loop, for any planner: capture, compute and output, each on its own thread. The newest frame wins; drives
// leave on time even when a frame is late; every way out ends in silence. Session::run is it for a session.
#pragma once

#include <atomic>

#include "sensing/depth_source.hpp"
#include "session/links/link.hpp"
#include "session/loop/output.hpp"
#include "session/loop/run_options.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct LoopSetting {
  OutputSetting output;
  /// Where frames are late, and all has been shed that can be, they may sound for longer than the hold, up to
  /// longest_auto_hold_s.
  bool lengthens_hold = false;
};

/// Runs until the source ends, `options.frames` are done, `stop` becomes true or something fails; an Error of any
/// thread ends all of them and is thrown here, after the link has got silence. Silence waits for nobody but the link:
/// the output thread sees itself that `stop` is true, whatever the others are doing, and what they log is written by a
/// thread of its own (log::Relay). A source, a device, a recorder or an observer that never comes back keeps this
/// function from returning, nothing more. Where anything fails `stop` becomes
/// true, so that nobody waits on for a reader. `stats` is filled as the loop goes and complete on every path; `planner`
/// is not busy afterwards.
void run_loop(sensing::DepthSource& source, Planner& planner, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const RunOptions& options, LoopStats& stats);

}  // namespace palpa::session
