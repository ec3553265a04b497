// Where solids and a held finger are put by hand: the pointer moves the finger, handles move and turn both, and what
// was done last can be undone. Knows neither session nor panels.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "viewer/hands/controls.hpp"
#include "viewer/hands/gizmo.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

class Placing {
 public:
  /// The things of a scene, each where the scene has it; `finger`: whether there is one to be held, too. Solids that
  /// were moved stay so where the scene is the `same`. A finger that nobody has moved yet waits above the highest
  /// solid.
  void begin(const Picture& rest, bool finger, bool same);

  /// Where each solid is, by T_world_rest; the finger, by T_world_finger.
  const std::vector<Transform>& poses() const { return poses_; }
  const Transform& finger() const { return finger_; }
  bool holds_finger() const { return holds_finger_; }
  /// Whether a solid is elsewhere than in the scene.
  bool moved() const;

  /// Takes what is meant for it: then it is nobody else's.
  bool handle(const WindowEvent& event, const Sight& sight);

  /// Whose handles are shown: a solid, after the last of them the finger; nothing: nobody's.
  std::optional<std::size_t> chosen() const { return chosen_; }
  void choose(std::optional<std::size_t> thing);
  const std::vector<std::string>& names() const { return names_; }  ///< of the things
  /// The finger goes where the pointer goes.
  bool follows() const { return follows_; }
  void follow(bool on) { follows_ = on; }
  void undo();
  /// All solids back to where the scene has them.
  void restore();

  /// The handles, as they lie in a picture.
  std::vector<FlatMark> marks(const Sight& sight) const;

 private:
  struct Step {
    std::size_t thing = 0;
    Transform before{1.0};
  };
  Transform& pose(std::size_t thing) { return thing < poses_.size() ? poses_[thing] : finger_; }
  Vec3 middle(std::size_t thing) const;
  void remember(std::size_t thing, const Transform& before);
  bool key(const WindowEvent& event);
  bool press(const WindowEvent& event, const Sight& sight);
  bool move(const WindowEvent& event, const Sight& sight);
  bool release(const WindowEvent& event);
  bool push_away(const WindowEvent& event, const Sight& sight);

  std::vector<Transform> poses_;
  std::vector<Vec3> middles_;  ///< of the solids at rest
  std::vector<std::string> names_;
  Transform finger_{1.0};
  bool holds_finger_ = false, finger_was_put_ = false, follows_ = true;
  std::optional<std::size_t> chosen_;
  std::optional<Handle> hovered_;
  std::vector<Step> history_;

  /// What a button that is held down does.
  struct Grip {
    Step step;
    std::optional<Handle> handle;  ///< none: it turns the finger
    Gizmo gizmo;
    Vec2 from{};
    Button button = Button::left;
  };
  std::optional<Grip> grip_;
  int held_ = 0;  ///< buttons that are down
};

/// The picture's solids and tile where `poses` take them from `rest`, of which it otherwise is a copy.
void pose_solids(Picture& picture, const Picture& rest, const std::vector<Transform>& poses);

}  // namespace palpa::viewer
