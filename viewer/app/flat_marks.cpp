#include "viewer/app/flat_marks.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace palpa::viewer {

void show_depths(const touch::Touch& touch, const std::vector<std::string>& solids, const Sight& sight,
                 std::vector<Depth>& depths, std::vector<FlatMark>& marks) {
  const shader::ViewPush push = projection(sight.viewpoint, sight.width, sight.height);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    if (finger.solid >= solids.size()) continue;
    depths.push_back({solids[finger.solid], finger.depth_m});
    const Projected at = project(push, Vec3(finger.section.centroid));
    if (!at.visible) continue;
    // The label's place: beside the contacts, and beside the foci and their numbers.
    double right = at.x;
    for (const touch::Focus& focus : finger.foci) {
      const Projected p = project(push, Vec3(focus.position));
      if (p.visible && (finger.placed || focus.points > 0)) right = std::max(right, p.x);
    }
    marks.push_back(
        {.points = {Vec2(right + 48 * sight.ratio, at.y)}, .label = fmt::format("{:.1f} mm", finger.depth_m * 1e3)});
  }
}

void show_reading(const Reading& reading, const Sight& sight, std::vector<FlatMark>& marks) {
  const Projected at = project(projection(sight.viewpoint, sight.width, sight.height), reading.at);
  if (!at.visible) return;
  std::string text = fmt::format("{}  {:.2f}  {:.2f}  {:.2f} mm", reading.what, reading.at.x * 1e3, reading.at.y * 1e3,
                                 reading.at.z * 1e3);
  if (reading.depth_m) text += fmt::format("\n{:.2f} mm deep", *reading.depth_m * 1e3);
  marks.push_back({.points = {Vec2(at.x, at.y + 34 * sight.ratio)}, .label = text});
}

}  // namespace palpa::viewer
