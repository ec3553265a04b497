// The things that are moved by hand in a live run: where hands have put them, and where the run has them.
#pragma once

#include <string>
#include <vector>

#include "viewer/hands/placing.hpp"
#include "viewer/live/held_finger.hpp"
#include "viewer/live/live_session.hpp"

namespace palpa::viewer {

class MovedByHand {
 public:
  Placing& placing() { return placing_; }
  const Placing& placing() const { return placing_; }
  HeldFinger& finger() { return finger_; }

  /// Call when a run of this scene begins. If things of this scene were moved before, the run gets them where they were
  /// put.
  void begin_run(LiveSession& session, const std::string& scene) const;
  /// Call when the scene is loaded, to take over its things. If the scene is the same as before, moved things stay
  /// where they were put. `holds_finger`: a finger is held, too.
  void begin_scene(LiveSession& session, const Picture& rest, const std::string& scene, bool holds_finger);
  /// Moves things where they are felt, and in `picture`, where they are seen. `rest` is the picture with nothing moved.
  /// Returns whether solids have moved.
  bool bring(LiveSession& session, const Picture& rest, Picture& picture);
  /// The same for the finger only, while there is no scene.
  void bring_finger() { finger_.put(placing_.finger()); }
  /// Call when the moved things have been saved: a run of that file moves nothing, whatever its name.
  void forget_scene() { scene_.clear(); }

 private:
  HeldFinger finger_;
  Placing placing_;
  std::vector<Transform> placed_;  ///< the solids' poses in the run
  std::string scene_;              ///< the scene that the things belong to; empty: none
};

}  // namespace palpa::viewer
