#include "viewer/app/moved_by_hand.hpp"

namespace palpa::viewer {

void MovedByHand::begin_run(LiveSession& session, const std::string& scene) const {
  if (scene == scene_) session.place(placing_.poses());
}

void MovedByHand::begin_scene(LiveSession& session, const Picture& rest, const std::string& scene, bool holds_finger) {
  placing_.begin(rest, holds_finger, scene == scene_);
  scene_ = scene;
  placed_.assign(placing_.poses().size(), Transform(1.0));
  session.place(placed_);  // it may have the poses of a scene with other solids
}

bool MovedByHand::bring(LiveSession& session, const Picture& rest, Picture& picture) {
  bring_finger();
  if (placed_ == placing_.poses()) return false;
  placed_ = placing_.poses();
  session.place(placed_);
  pose_solids(picture, rest, placed_);
  return true;
}

}  // namespace palpa::viewer
