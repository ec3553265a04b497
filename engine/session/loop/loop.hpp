// The live loop, for any planner: capture, compute and output, each on its own thread. The newest frame wins. Drives
// leave on time even when a frame is late. However the loop ends, it ends in silence. Session::run is this loop for a
// session.
#pragma once

#include <atomic>

#include "sensing/depth_source.hpp"
#include "session/clock.hpp"
#include "session/links/link.hpp"
#include "session/loop/output.hpp"
#include "session/loop/run_options.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/stats.hpp"

namespace palpa::session {

struct LoopSetting {
  OutputSetting output;
  /// If frames are late although all work that can be shed has been shed, frames may sound for longer than the hold, up
  /// to longest_auto_hold_s.
  bool lengthens_hold = false;
};

/// Runs until the source ends, `options.frames` are done, `stop` becomes true or something fails; an Error of any
/// thread ends all threads and is thrown here, after the link has been silenced. Silence waits only for the link: the
/// output thread checks `stop` itself, whatever the other threads are doing, and a separate thread writes their log
/// messages (log::Relay). If a source, a device, a recorder or an observer never returns, this function does not return
/// either, but nothing else is affected. If anything fails, `stop` becomes true, so that nobody keeps waiting for a
/// reader. `stats` is filled while the loop runs and is complete on every path. Afterwards, `planner` is not busy. All
/// times are those of `clock`.
void run_loop(sensing::DepthSource& source, Planner& planner, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const RunOptions& options, LoopStats& stats, const Clock& clock = Clock());

}  // namespace palpa::session
