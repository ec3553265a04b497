// Touch as events: the data about a finger that a button, a knob or a game needs, reported once when it happens.
//
//   touch    a finger touches a solid that it did not touch in the frame before
//   move     it has moved by `move_m` or more, along the surface or in depth, since its last event
//   press    it passes the solid's press depth
//   release  it has left the solid, or the stream has ended
//
// When a finger touches, presses and releases is decided in touches.hpp.
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

#include "base/files/json_writer.hpp"
#include "base/words.hpp"
#include "geometry/solid.hpp"
#include "session/watch/touches.hpp"
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
  double move_m = 0.5e-3;  ///< 0: every frame is a move
};

class EventTracker {
 public:
  /// `solids` are those of the touches; only their press depths are kept. If no frame comes for `hold_s`, every finger
  /// is released. A finger that is missing from frames for less than half of `hold_s` is not released, because a camera
  /// may miss it for a frame or two. Its release has the time at which it had been missing for that long. If its id
  /// returns in time, the touch continues.
  explicit EventTracker(std::span<const geometry::Solid> solids, const EventOptions& options = {}, double hold_s = 0.1);

  /// The events of the next frame: releases first, then finger by finger in the order of `touch`. `hands` as in
  /// Touches::update. If the time goes backwards, tracking restarts: fingers that touched are released first, as by
  /// end(). Valid until the next call.
  std::span<const Event> update(const touch::Touch& touch, double time_s, std::optional<std::uint32_t> hands = 1);
  /// To be called if no frame has come for hold_s after the last one. update() also detects this, but only with the
  /// next frame.
  std::span<const Event> expire();
  /// The end of the stream: releases all fingers that still touch, at the time of the last frame.
  std::span<const Event> end();
  /// See Touches::take_over.
  void take_over(const EventTracker& other) { touches_.take_over(other.touches_); }

 private:
  /// The last event's values of a finger that touches.
  struct Told {
    std::uint32_t id = 0;
    float depth_m = 0;
    glm::vec3 centroid{};
  };

  void release_ended();
  void follow(const HeldTouch& held);
  void tell(EventKind kind, const HeldTouch& held, double time_s);

  EventOptions options_;
  Touches touches_;
  std::vector<Told> told_;  ///< no id twice
  std::vector<Event> events_;
};

/// Writes one event as a complete document on one line:
///   {"event":"touch","time_s":1.5,"solid":"knob","finger":0,"depth_m":0.001,"centroid_m":[0.01,0,0.02]}
/// `json` is cleared first and keeps its storage.
void write_event_line(const Event& event, std::span<const std::string> solid_names, JsonWriter& json);

}  // namespace palpa::session
