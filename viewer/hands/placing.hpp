// Places solids and a held finger by hand. The pointer moves the finger, handles move and turn solids and finger, and
// the last move can be undone. Knows neither the session nor the panels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "viewer/hands/controls.hpp"
#include "viewer/hands/gizmo.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

class Placing {
 public:
  /// Takes the things of a scene, each where the scene has it. `finger`: there is also a finger to hold. If the scene
  /// is the `same`, solids that were moved stay where they are. A finger that has not been moved yet waits above the
  /// highest solid.
  void begin(const Picture& rest, bool finger, bool same);

  /// The poses: T_world_rest of each solid, and T_world_finger of the finger.
  const std::vector<Transform>& poses() const { return poses_; }
  const Transform& finger() const { return finger_; }
  bool holds_finger() const { return holds_finger_; }
  /// Whether a solid is not where the scene has it.
  bool moved() const;

  /// Another program has moved a solid. Undo knows nothing of it.
  void put(std::uint32_t solid, const Transform& T_world_rest) {
    if (solid < poses_.size()) poses_[solid] = T_world_rest;
  }

  /// Returns true if the event was meant for this object. Nobody else may handle it then.
  bool handle(const WindowEvent& event, const Sight& sight);

  /// The thing whose handles are shown: a solid, or the finger, whose index follows the last solid's. nullopt: none.
  std::optional<std::size_t> chosen() const { return chosen_; }
  void choose(std::optional<std::size_t> thing);
  const std::vector<std::string>& names() const { return names_; }  ///< of the things
  /// Whether the finger follows the pointer.
  bool follows() const { return follows_; }
  void follow(bool on) { follows_ = on; }
  void undo();
  bool can_undo() const { return !history_.empty(); }
  /// Returns all solids to where the scene has them.
  void restore();

  /// The handles in a picture.
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

  /// What a held button does.
  struct Grip {
    Step step;
    std::optional<Handle> handle;  ///< nullopt: the finger is turned
    Gizmo gizmo;
    Vec2 from{};
    Button button = Button::left;
  };
  std::optional<Grip> grip_;
  int held_ = 0;  ///< buttons that are down
};

/// Moves the picture's solids and tile from their places in `rest` by `poses`. `picture` is otherwise a copy of `rest`.
void pose_solids(Picture& picture, const Picture& rest, const std::vector<Transform>& poses);

}  // namespace palpa::viewer
