// Touch as events: the data about a finger that a button, a knob or a game needs, reported once when it happens.
//
//   touch    a finger touches a solid that it did not touch in the frame before
//   move     it has moved by `move_m` or more, along the surface or in depth, since its last event
//   press    it passes the solid's press depth; reported again only after it has come back up to `rearm` of that depth
//   release  it has left the solid, or the stream has ended
//
// Every touch is followed by exactly one release with the same finger and solid; moves and presses lie between them. A
// pure state machine: the same touches give the same events. Fingers are identified by their id, which is assigned
// earlier (touch/fingers/follow.hpp).
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_writer.hpp"
#include "base/words.hpp"
#include "geometry/solid.hpp"
#include "session/watch/press.hpp"
#include "touch/types.hpp"

namespace palpa::session {

enum class EventKind { touch, move, press, release };

inline constexpr Word<EventKind> event_words[] = {{"touch", EventKind::touch},
                                                  {"move", EventKind::move},
                                                  {"press", EventKind::press},
                                                  {"release", EventKind::release}};

struct Event {
  EventKind kind = EventKind::touch;
  double time_s = 0;         ///< capture of the frame, on the source's clock; for a release, see EventTracker
  std::uint32_t solid = 0;   ///< index into the scene's solids
  std::uint32_t finger = 0;  ///< touch::Finger::id
  float depth_m = 0;         ///< touch::Finger::depth_m; for a release, the last one seen
  glm::vec3 centroid{};      ///< of its contacts, metres, world; for a release, the last one seen
};

struct EventOptions {
  double move_m = 0.5e-3;        ///< 0: every frame is a move
  double rearm = default_rearm;  ///< of the press depth: above it, a finger that presses still does
};

class EventTracker {
 public:
  /// `solids` are those of the touches; only their press depths are kept. If no frame comes for `hold_s`, every finger
  /// is released. A finger that is missing from frames for less than half of `hold_s` is not released, because a camera
  /// may miss it for a frame or two. Its release has the time at which it had been missing for that long. If its id
  /// returns in time, the touch continues.
  explicit EventTracker(std::span<const geometry::Solid> solids, const EventOptions& options = {}, double hold_s = 0.1);

  /// The events of the next frame: releases first, then finger by finger in the order of `touch`. If the time goes
  /// backwards, tracking restarts: fingers that touched are released first, as by end(). Valid until the next
  /// call.
  std::span<const Event> update(const touch::Touch& touch, double time_s);
  /// To be called if no frame has come for hold_s after the last one. update() also detects this, but only with the
  /// next frame.
  std::span<const Event> expire();
  /// The end of the stream: releases all fingers that still touch, at the time of the last frame.
  std::span<const Event> end();

 private:
  struct Held {
    std::uint32_t id = 0;
    std::uint32_t solid = 0;
    double seen_s = 0;
    float depth = 0, told_depth = 0;
    glm::vec3 centroid{}, told_centroid{};
    bool pressed = false;
    bool seen = false;  ///< in this frame
  };

  Held* held_of(std::uint32_t id);
  void release_missing(double time_s);
  void release_all();
  void release(const Held& held, double time_s);
  void follow(Held& held, const touch::Finger& finger, double time_s, bool fresh);
  void tell(EventKind kind, Held& held, double time_s);

  std::vector<std::optional<double>> press_depth_m_;  ///< by solid
  EventOptions options_;
  double hold_s_, grace_s_;
  double last_s_ = 0;
  bool begun_ = false;
  std::vector<Held> held_;  ///< in the order of their touches; no id twice
  std::vector<Event> events_;
};

/// Writes one event as a complete document on one line:
///   {"event":"touch","time_s":1.5,"solid":"knob","finger":0,"depth_m":0.001,"centroid_m":[0.01,0,0.02]}
/// `json` is cleared first and keeps its storage.
void write_event_line(const Event& event, std::span<const std::string> solid_names, JsonWriter& json);

}  // namespace palpa::session
