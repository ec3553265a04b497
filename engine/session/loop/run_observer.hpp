// What watches a run: run_loop and Session::run report to it.
#pragma once

#include <cstdint>
#include <span>

#include "session/links/hand_over.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/events.hpp"

namespace palpa::session {

/// Override what you want to know. Each function must return quickly, and throw nothing but Error, which ends the run.
class RunObserver {
 public:
  virtual ~RunObserver() = default;

  /// Called on the capture thread: a frame with this number has come and will be planned or replaced by a newer one.
  virtual void arrived(std::uint64_t /*sequence*/) {}
  /// Called on the calling thread with each frame, before it is planned.
  virtual void started(const SkinFrame&) {}
  /// Called on the calling thread, before a frame's events.
  virtual void planned(const FrameReport&, const Plan&) {}
  /// Called on the calling thread, once, when no frame has come for the hold after one was planned. Never called with
  /// every_frame, because its frames wait for the loop.
  virtual void expired() {}
  /// Called on the output thread after every drive that the link took, including the last silence: whether it sounds,
  /// and how many drives have passed each hand-over.
  virtual void sent(bool /*sounds*/, const HandOver& /*counts*/) {}
  /// Called on the thread of RunOptions::record after the loop's end, before each frame that is still recorded: the
  /// number of such frames.
  virtual void recording_rest(std::uint64_t /*frames*/) {}

  /// Called on the calling thread when another program has moved a solid (control/live_values.hpp).
  virtual void moved(std::uint32_t /*solid*/, const Transform& /*T_world_rest*/) {}

  /// Only of a session whose setting has events; run_loop makes none. Called on the calling thread after every frame,
  /// even without events, and when fingers are released because no frame comes or the run ends.
  virtual void events(std::span<const Event>) {}
};

/// Does nothing.
inline RunObserver no_observer;

}  // namespace palpa::session
