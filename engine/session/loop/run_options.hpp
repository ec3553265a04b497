// The options of a run, for run_loop and Session::run.
#pragma once

#include <cstdint>
#include <functional>

#include "sensing/depth_source.hpp"
#include "session/loop/run_observer.hpp"
#include "session/watch/event_sink.hpp"

namespace palpa::session {

class Session;

/// What may change a run between its frames. All calls come from the calling thread, and must return quickly.
class RunChanges {
 public:
  virtual ~RunChanges() = default;
  /// Before each frame is started: a Session::set_pose in it holds from this frame on.
  virtual void before_frame(Session&) {}
  /// Whether another scene waits. No frame is started until those in progress are done; then
  /// comes take_scene(), which calls exchange_scene().
  virtual bool has_scene() const { return false; }
  virtual void take_scene(Session&) {}
};

struct RunOptions {
  std::uint64_t frames = 0;  ///< stop after this many captured frames; 0: at the source's end
  /// False: a frame that comes while another one waits replaces it; the same holds for plans. True: each frame and plan
  /// waits for the next thread, so every frame is processed and every plan is played.
  bool every_frame = false;
  RunObserver* observer = &no_observer;  ///< never null
  /// Gets the events before the observer does. Only of a session whose setting has events; run_loop makes none.
  EventSink* events = nullptr;
  RunChanges* changes = nullptr;  ///< of Session::run; run_loop makes none
  /// Called with every frame, e.g. to record it, on a separate thread, so that a slow disk does not delay touches. If
  /// frames come while it is busy, they wait, and are recorded after the loop's end at the latest. Frames for which
  /// there is no room are left out (never with every_frame) and counted as `unrecorded`; so are those that still wait
  /// 0.3 s after `stop` became true. It must throw nothing but Error, which ends the run.
  std::function<void(const sensing::FrameSet&)> record{};
  /// Room for the images of frames that wait for `record`. 0: only the newest frame waits.
  std::uint64_t record_waiting_bytes = 0;
  bool steps = true;  ///< as the link's LinkSetting::steps; for LoopStats::ear
};

}  // namespace palpa::session
