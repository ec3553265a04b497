// What is moved by hand in a live run: where hands have put it, and where the run has it.
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

  /// A run of this scene begins: where the hands know its things, it has them where they were put.
  void begin_run(LiveSession& session, const std::string& scene) const;
  /// The scene is there: its things, but a scene's that the hands know stay where they were put. `holds_finger`:
  /// whether one is held, too.
  void begin_scene(LiveSession& session, const Picture& rest, const std::string& scene, bool holds_finger);
  /// Brings what was moved to where it is felt, and to where it is seen in `picture`, which at rest is `rest`. Whether
  /// solids have moved.
  bool bring(LiveSession& session, const Picture& rest, Picture& picture);
  /// The same of the finger alone, while there is no scene.
  void bring_finger() { finger_.put(placing_.finger()); }
  /// What was moved is in a file now: a run of that file moves nothing, whatever its name.
  void forget_scene() { scene_.clear(); }

 private:
  HeldFinger finger_;
  Placing placing_;
  std::vector<Transform> placed_;  ///< as the run has the solids
  std::string scene_;              ///< whose things they are; empty: none's
};

}  // namespace palpa::viewer
