// The live loop: capture, compute and output, each on its own thread. The newest frame wins; drives leave on time even
// when a frame is late; every way out ends in silence.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "sensing/depth_source.hpp"
#include "session/chain.hpp"
#include "session/link.hpp"
#include "session/output.hpp"
#include "session/stats.hpp"

namespace palpa::session {

struct LoopSetting {
  OutputSetting output;
  std::uint64_t frames = 0;  ///< stop after that many captured frames; 0: at the source's end
  /// Off: a frame that comes while another waits replaces it. On: capture waits, every frame is looked at.
  bool every_frame = false;
};

/// What others may look at while the loop runs. Called on the thread named; must not throw anything but Error and not
/// linger.
struct LoopObservers {
  std::function<void(const sensing::FrameSet&)> captured;        ///< capture thread: every frame, e.g. to record it
  std::function<void(const FrameReport&, const Plan&)> planned;  ///< compute thread (the caller's)
};

/// Runs until the source ends, `setting.frames` are done, `stop` becomes true or something fails; an Error of any
/// thread ends all three and is thrown here, after the link has got silence. `stats` is filled as the loop goes and
/// complete on every path.
void run_loop(sensing::DepthSource& source, Chain& chain, Link& link, const LoopSetting& setting,
              std::atomic<bool>& stop, const LoopObservers& observers, LoopStats& stats);

}  // namespace palpa::session
