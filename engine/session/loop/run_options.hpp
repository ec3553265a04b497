// The options and the observers of a run, for run_loop and Session::run.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "sensing/depth_source.hpp"
#include "session/links/hand_over.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/planner.hpp"
#include "session/watch/events.hpp"

namespace palpa::session {

/// The observer functions must throw nothing but Error, which ends the run.
struct RunOptions {
  std::uint64_t frames = 0;  ///< stop after this many captured frames; 0: at the source's end
  /// False: a frame that comes while another one waits replaces it; the same holds for plans. True: each frame and plan
  /// waits for the next thread, so every frame is processed and every plan is played.
  bool every_frame = false;
  /// Only for a session, which makes the events; run_loop makes none. Called on the calling thread after every frame,
  /// even without events, and when fingers are released because no frame comes or the run ends. It must return quickly.
  std::function<void(std::span<const Event>)> events{};
  /// Called on the calling thread with each frame, before it is planned. It must return quickly.
  std::function<void(const SkinFrame&)> started{};
  /// Called on the calling thread, before a frame's events. It must return quickly.
  std::function<void(const FrameReport&, const Plan&)> planned{};
  /// Called on the calling thread, once, when no frame has come for the hold after one was planned. Never called with
  /// every_frame, because its frames wait for the loop.
  std::function<void()> expired{};
  /// Called on the capture thread: a frame with this number has come and will be planned or replaced by a newer one.
  /// Must return quickly.
  std::function<void(std::uint64_t sequence)> arrived{};
  /// Called on the output thread after every drive that the link took, including the last silence: whether it sounds,
  /// and how many drives have passed each hand-over. Must return quickly.
  std::function<void(bool sounds, const HandOver& counts)> sent{};
  /// Called with every frame, e.g. to record it, on a separate thread, so that a slow disk does not delay touches. If
  /// frames come while it is busy, they wait, and are recorded after the loop's end at the latest. Frames for which
  /// there is no room are left out (never with every_frame) and counted as `unrecorded`; so are those that still wait
  /// 0.3 s after `stop` became true.
  std::function<void(const sensing::FrameSet&)> record{};
  /// Called on that thread after the loop's end, before each frame that is still recorded: the number of such frames.
  std::function<void(std::uint64_t frames)> recording_rest{};
  /// Room for the images of frames that wait for `record`. 0: only the newest frame waits.
  std::uint64_t record_waiting_bytes = 0;
};

}  // namespace palpa::session
