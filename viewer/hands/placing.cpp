#include "viewer/hands/placing.hpp"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>

namespace palpa::viewer {
namespace {

constexpr std::size_t most_steps = 200;
constexpr double above_m = 4e-3;                       ///< where a finger waits
constexpr double wheel_m = 1e-3, fine_wheel_m = 1e-4;  ///< per step

}  // namespace

void Placing::begin(const Picture& rest, bool finger, bool same) {
  std::vector<Box> boxes;
  std::vector<std::string> names;
  for (const SurfaceMark& surface : rest.solids) {
    if (surface.solid >= boxes.size()) {
      boxes.resize(surface.solid + 1);
      names.push_back(surface.name);
    }
    for (const Vec3& p : surface.mesh.positions)
      boxes[surface.solid].add(p);
  }
  if (!same || boxes.size() != poses_.size()) {
    poses_.assign(boxes.size(), Transform(1.0));
    history_.clear();
    chosen_.reset();
    grip_.reset();
  }
  middles_.clear();
  for (const Box& box : boxes)
    middles_.push_back(box.empty() ? Vec3(0) : box.centre());
  names_ = std::move(names);
  holds_finger_ = finger;
  if (finger) names_.emplace_back("finger");
  if (chosen_ && *chosen_ >= names_.size()) chosen_.reset();
  if (finger_was_put_) return;
  const Vec3 top = rest.tile ? (Vec3((*rest.tile)[0]) + Vec3((*rest.tile)[2])) / 2.0 : Vec3(0);
  finger_ = glm::translate(Transform(1.0), top + Vec3(0, above_m, 0));
}

bool Placing::moved() const {
  return std::ranges::any_of(poses_, [](const Transform& pose) { return pose != Transform(1.0); });
}

void Placing::choose(std::optional<std::size_t> thing) {
  chosen_ = thing && *thing < names_.size() ? thing : std::nullopt;
  hovered_.reset();
}

Vec3 Placing::middle(std::size_t thing) const {
  return thing < poses_.size() ? transform_point(poses_[thing], middles_[thing]) : Vec3(finger_[3]);
}

void Placing::remember(std::size_t thing, const Transform& before) {
  if (pose(thing) == before) return;
  if (history_.size() == most_steps) history_.erase(history_.begin());
  history_.push_back({thing, before});
}

void Placing::undo() {
  if (history_.empty()) return;
  const Step last = history_.back();
  history_.pop_back();
  if (last.thing < names_.size()) pose(last.thing) = last.before;
}

void Placing::restore() {
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const Transform before = std::exchange(poses_[i], Transform(1.0));
    remember(i, before);
  }
}

bool Placing::handle(const WindowEvent& event, const Sight& sight) {
  switch (event.kind) {
    case WindowEvent::Kind::press:
      ++held_;
      return press(event, sight);
    case WindowEvent::Kind::release:
      held_ = std::max(held_ - 1, 0);
      return release(event);
    case WindowEvent::Kind::move:
      return move(event, sight);
    case WindowEvent::Kind::scroll:
      return push_away(event, sight);
    case WindowEvent::Kind::key:
      return event.down && key(event);
    case WindowEvent::Kind::text:
    case WindowEvent::Kind::drop:
    case WindowEvent::Kind::damage:
      break;
  }
  return false;
}

bool Placing::key(const WindowEvent& event) {
  if (event.key == Key::escape && grip_) {
    pose(grip_->step.thing) = grip_->step.before;
    grip_.reset();
    return true;
  }
  if (event.key == Key::escape && chosen_) {
    choose(std::nullopt);
    return true;
  }
  if (event.key == key_of('z') && event.ctrl && !grip_) {
    undo();
    return true;
  }
  if (event.key == key_of('g')) {
    choose(chosen_ ? *chosen_ + 1 : 0);
    return true;
  }
  if (event.key == key_of('m') && holds_finger_) {
    follows_ = !follows_;
    return true;
  }
  return false;
}

bool Placing::press(const WindowEvent& event, const Sight& sight) {
  if (grip_) return true;
  const Vec2 at(event.x, event.y);
  if (event.button == Button::right && holds_finger_) {
    grip_ = Grip{{poses_.size(), finger_}, std::nullopt, {}, at, event.button};
    return true;
  }
  if (event.button != Button::left || !chosen_) return false;
  const Gizmo gizmo = gizmo_at(middle(*chosen_), sight);
  hovered_ = handle_at(gizmo, sight, event.x, event.y);
  if (!hovered_) return false;
  grip_ = Grip{{*chosen_, pose(*chosen_)}, hovered_, gizmo, at, event.button};
  return true;
}

bool Placing::move(const WindowEvent& event, const Sight& sight) {
  const Vec2 at(event.x, event.y);
  if (grip_ && grip_->handle) {
    const auto motion = dragged(grip_->gizmo, *grip_->handle, sight, grip_->from, at, event.ctrl);
    if (motion) pose(grip_->step.thing) = *motion * grip_->step.before;
    finger_was_put_ = finger_was_put_ || grip_->step.thing == poses_.size();
    return true;
  }
  if (grip_) {  // the finger turns around its tip, like a ball under the pointer
    const Basis b = basis(sight.viewpoint);
    const double per_pixel = std::numbers::pi / std::max(sight.height, 1.0);
    const Transform& before = grip_->step.before;
    Transform turned = glm::rotate(Transform(1.0), (at.x - grip_->from.x) * per_pixel, b.forward) *
                       glm::rotate(Transform(1.0), (at.y - grip_->from.y) * per_pixel, b.right) * before;
    turned[3] = before[3];
    finger_ = turned;
    finger_was_put_ = true;
    return true;
  }
  const bool over_finger = chosen_ && *chosen_ == poses_.size();
  if (chosen_) hovered_ = handle_at(gizmo_at(middle(*chosen_), sight), sight, event.x, event.y);
  if (!holds_finger_ || !follows_ || held_ > 0 || over_finger || hovered_) return false;
  const Vec3 tip(finger_[3]);
  const auto under =
      meet(line_of_sight(sight.viewpoint, at.x, at.y, sight.width, sight.height), tip, basis(sight.viewpoint).forward);
  if (under) finger_[3] = Vec4(*under, 1);
  finger_was_put_ = true;
  return false;
}

bool Placing::release(const WindowEvent& event) {
  if (!grip_ || event.button != grip_->button) return false;
  remember(grip_->step.thing, grip_->step.before);
  grip_.reset();
  return true;
}

bool Placing::push_away(const WindowEvent& event, const Sight& sight) {
  if (!holds_finger_ || !follows_ || event.ctrl) return false;
  const double way = event.steps * (event.shift ? fine_wheel_m : wheel_m);
  finger_[3] += Vec4(basis(sight.viewpoint).forward * way, 0);
  finger_was_put_ = true;
  return true;
}

std::vector<FlatMark> Placing::marks(const Sight& sight) const {
  if (!chosen_) return {};
  const Gizmo gizmo =
      grip_ && grip_->handle ? Gizmo{middle(*chosen_), grip_->gizmo.size_m} : gizmo_at(middle(*chosen_), sight);
  return gizmo_marks(gizmo, sight, grip_ ? grip_->handle : hovered_);
}

void pose_solids(Picture& picture, const Picture& rest, const std::vector<Transform>& poses) {
  picture.solids = rest.solids;
  for (SurfaceMark& surface : picture.solids) {
    if (surface.solid >= poses.size() || poses[surface.solid] == Transform(1.0)) continue;
    for (Vec3& p : surface.mesh.positions)
      p = transform_point(poses[surface.solid], p);
  }
  picture.tile = rest.tile;
  if (!rest.tile || rest.tile_solid >= poses.size()) return;
  for (glm::vec3& corner : *picture.tile)
    corner = glm::vec3(transform_point(poses[rest.tile_solid], Vec3(corner)));
}

}  // namespace palpa::viewer
