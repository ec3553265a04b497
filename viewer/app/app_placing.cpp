// Moving things by hand, and how deep fingers are.
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
  return {data_.state.viewpoint, static_cast<double>(size.width), static_cast<double>(size.height), ratio_};
}

/// Moves things to where they are seen and felt.
void App::place() {
  if (!run_.scene()) return moved_.bring_finger();
  if (moved_.bring(*run_.session(), run_.scene()->picture, live_.picture)) stale_.add(Stale::surfaces);
}

void App::show_placing(const Size& size) {
  if (!data_.live) return;
  const Sight seen = sight(size);
  const Placing& placing = moved_.placing();
  data_.marks = placing.marks(seen);
  PanelData::Placed& placed = data_.placed;
  placed.things = placing.names();
  placed.chosen = placing.chosen();
  placed.follows = placing.follows();
  placed.moved = placing.moved();
  placed.can_undo = placing.can_undo();
  placed.tip = placing.holds_finger() ? std::optional(Vec3(placing.finger()[3])) : std::nullopt;
  show_depths(size);
}

/// How deep fingers are, beside their contacts.
void App::show_depths(const Size& size) {
  const Sight seen = sight(size);
  data_.depths.clear();
  const std::shared_ptr<const LiveScene>& scene = run_.scene();
  if (!scene) return;
  const touch::Touch& touch = run_.session()->snapshot().touch;
  const shader::ViewPush push = projection(seen.viewpoint, seen.width, seen.height);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    if (finger.solid >= scene->solid_names.size()) continue;
    data_.depths.push_back({scene->solid_names[finger.solid], finger.depth_m});
    const Projected at = project(push, Vec3(finger.section.centroid));
    if (!at.visible) continue;
    // The label's place: beside the contacts, and beside the foci and their numbers.
    Vec2 beside(at.x, at.y);
    for (const touch::Focus& focus : finger.foci) {
      const Projected p = project(push, Vec3(focus.position));
      if (p.visible && (finger.placed || focus.points > 0)) beside.x = std::max(beside.x, p.x);
    }
    beside.x += 48 * seen.ratio;
    data_.marks.push_back({.points = {beside}, .label = fmt::format("{:.1f} mm", finger.depth_m * 1e3)});
  }
}

/// What was read, below the point that was read.
void App::show_reading(const Size& size) {
  if (!data_.reading) return;
  const Reading& reading = *data_.reading;
  const Projected at = project(projection(data_.state.viewpoint, size.width, size.height), reading.at);
  std::string text = fmt::format("{}  {:.2f}  {:.2f}  {:.2f} mm", reading.what, reading.at.x * 1e3, reading.at.y * 1e3,
                                 reading.at.z * 1e3);
  if (reading.depth_m) text += fmt::format("\n{:.2f} mm deep", *reading.depth_m * 1e3);
  if (at.visible) data_.marks.push_back({.points = {Vec2(at.x, at.y + 34 * ratio_)}, .label = text});
}

/// Takes what the panels changed in the values that show_placing() has just given them.
void App::take_placing() {
  if (!data_.live) return;
  Placing& placing = moved_.placing();
  if (data_.placed.chosen != placing.chosen()) placing.choose(data_.placed.chosen);
  placing.follow(data_.placed.follows);
}

void App::do_placing(double now_s) {
  PanelData::Placed& placed = data_.placed;
  if (std::exchange(placed.undo, false)) moved_.placing().undo();
  if (std::exchange(placed.restore, false)) moved_.placing().restore();
  place();
  if (std::exchange(placed.save, false)) save_scene(placed.file, now_s);
}

void App::save_scene(const std::string& file, double now_s) {
  if (!run_.scene()) return;
  try {
    const Outputs outputs({{"save as", file}});
    geometry::write_glb(file, meshes_of(*run_.scene(), moved_.placing().poses()));
  } catch (const Error& error) {
    return say(log::Level::error, error.what(), now_s);
  }
  say(log::Level::info, file + ": is now the scene", now_s);
  remember_file(file);
  moved_.forget_scene();
  LiveEdit edit = data_.edit;
  edit.replace_scene(file);
  change_run(std::move(edit), true);
}

}  // namespace palpa::viewer
