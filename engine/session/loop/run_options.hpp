// How a run goes, and who looks on while it does: what run_loop and Session::run are asked for.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "sensing/depth_source.hpp"
#include "session/links/plan.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/events.hpp"

namespace palpa::session {

/// Functions that look on must throw nothing but Error, which ends the run.
struct RunOptions {
  std::uint64_t frames = 0;  ///< stop after that many captured frames; 0: at the source's end
  /// Off: a frame that comes while another waits replaces it, and so does a plan. On: each waits for the next thread,
  /// so every frame is looked at and every plan is played.
  bool every_frame = false;
  /// Of a session, whose events they are; run_loop makes none. On the calling thread, after every frame, also without
  /// events, and when fingers let go because no frame comes or the run ends. It must not linger.
  std::function<void(std::span<const Event>)> events{};
  /// On the calling thread, before a frame's events. It must not linger.
  std::function<void(const FrameReport&, const Plan&)> planned{};
  /// On the calling thread, once when no frame has come for the hold after one was planned. Never with every_frame,
  /// whose frames wait for the loop.
  std::function<void()> expired{};
  /// Capture thread: a frame with that number has come, and will be planned or replaced by a newer one. Must not
  /// linger.
  std::function<void(std::uint64_t sequence)> arrived{};
  /// Output thread, after every drive that the link took, the last silence too: whether it sounds. Must not linger.
  std::function<void(bool sounds)> sent{};
  /// On a thread of its own, so that a slow disk delays no touch: every frame, e.g. to be written down. Frames that
  /// come while it is busy are left out, all but the newest (never with every_frame), and counted as `unrecorded`.
  std::function<void(const sensing::FrameSet&)> record{};
};

}  // namespace palpa::session
