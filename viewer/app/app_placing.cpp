// What is moved by hand, and how deep fingers are.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/error.hpp"
#include "base/outputs.hpp"
#include "geometry/gltf/write.hpp"
#include "viewer/app/app.hpp"
#include "viewer/live/live_picture.hpp"

namespace palpa::viewer {

Sight App::sight(const Size& size) const {
  return {desk_.state.viewpoint, static_cast<double>(size.width), static_cast<double>(size.height), ratio_};
}

bool App::holds_finger() const {
  const auto source = running_.find("--source");
  if (source == running_.end() || source->second.empty()) return false;
  const std::string& name = source->second.front();
  return name == "mouse" || name.starts_with("mouse:");
}

/// A run of another scene begins: what was moved in the one before stays there.
void App::place_anew() {
  const std::string path = running_.contains("--scene") ? running_.at("--scene").front() : "";
  same_scene_ = std::exchange(placed_scene_, path) == path;
  if (same_scene_) live_->place(placing_.poses());
}

void App::begin_placing() {
  placing_.begin(scene_->picture, holds_finger(), same_scene_);
  same_scene_ = true;
  finger_.put(placing_.finger());
  placed_.assign(placing_.poses().size(), Transform(1.0));
  live_->place(placed_);  // of a scene of other solids it may have been told what the one before had
  place();
}

/// Brings what was moved to where it is seen and felt.
void App::place() {
  finger_.put(placing_.finger());
  if (!scene_ || placed_ == placing_.poses()) return;
  placed_ = placing_.poses();
  live_->place(placed_);
  pose_solids(live_picture_, scene_->picture, placed_);
  surfaces_changed();
}

void App::show_placing(const Size& size) {
  if (!desk_.live) return;
  const Sight seen = sight(size);
  desk_.marks = placing_.marks(seen);
  Desk::Placed& placed = desk_.placed;
  placed.things = placing_.names();
  placed.chosen = placing_.chosen();
  placed.follows = placing_.follows();
  placed.moved = placing_.moved();
  placed.tip = placing_.holds_finger() ? std::optional(Vec3(placing_.finger()[3])) : std::nullopt;
  desk_.depths.clear();
  if (!scene_) return;
  const touch::Touch& touch = live_->snapshot().touch;
  const shader::ViewPush push = projection(seen.viewpoint, seen.width, seen.height);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    if (finger.solid >= scene_->solid_names.size()) continue;
    desk_.depths.push_back({scene_->solid_names[finger.solid], finger.depth_m});
    const Projected at = project(push, Vec3(finger.section.centroid));
    if (!at.visible) continue;
    // Beside its contacts and foci, and their numbers.
    Vec2 beside(at.x, at.y);
    for (const touch::Focus& focus : finger.foci) {
      const Projected p = project(push, Vec3(focus.position));
      if (p.visible && (finger.placed || focus.points > 0)) beside.x = std::max(beside.x, p.x);
    }
    beside.x += 48 * seen.ratio;
    desk_.marks.push_back({.points = {beside}, .label = fmt::format("{:.1f} mm", finger.depth_m * 1e3)});
  }
}

/// What panels changed of what show_placing() has just told them.
void App::take_placing() {
  if (!desk_.live) return;
  if (desk_.placed.chosen != placing_.chosen()) placing_.choose(desk_.placed.chosen);
  placing_.follow(desk_.placed.follows);
}

void App::do_placing(double now_s) {
  Desk::Placed& placed = desk_.placed;
  if (std::exchange(placed.undo, false)) placing_.undo();
  if (std::exchange(placed.restore, false)) placing_.restore();
  place();
  if (std::exchange(placed.save, false)) save_scene(placed.file, now_s);
}

void App::save_scene(const std::string& file, double now_s) {
  if (!scene_) return;
  try {
    const Outputs outputs({{"save as", file}});
    geometry::write_glb(file, meshes_of(*scene_, placing_.poses()));
  } catch (const Error& error) {
    return say(log::Level::error, error.what(), now_s);
  }
  say(log::Level::info, file + ": is the scene now", now_s);
  desk_.given["--scene"] = {file};
  desk_.given.erase("--gltf-scene");
  // What was moved is in the file now: the run that begins with it moves nothing, be it the same file as before.
  placed_scene_.clear();
  anew_ = true;
}

}  // namespace palpa::viewer
