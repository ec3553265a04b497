#include "viewer/live/live_picture.hpp"

#include <utility>
#include <vector>

namespace palpa::viewer {

void show_live(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, const Seen& seen, bool depth) {
  std::vector<geometry::Solid> named(scene.solid_names.size());
  for (std::size_t i = 0; i < named.size(); ++i)
    named[i].name = scene.solid_names[i];
  show_touch(picture, named, seen.points, snapshot.touch);
  picture.skin_count = seen.points.size();
  std::erase_if(picture.images, [](const ImageMark& image) { return image.layer == Layer::depth; });
  if (depth && !seen.images.frames.empty()) show_depth(picture, scene.cameras, seen.images.frames);

  const array::Schedule& schedule = snapshot.plan.schedule;
  std::vector<touch::Placement> placements;
  for (std::uint32_t f = 0; f < snapshot.touch.finger_count && f < schedule.voice_count; ++f) {
    const touch::Finger& finger = snapshot.touch.fingers[f];
    const array::Voice& voice = schedule.voices[f];
    touch::Placement placement;
    placement.foci = finger.foci;
    placement.together = voice.foci_per_slot > 1;
    // Of a method with foci of its own every focus has its place.
    placement.complete = finger.placed || voice.foci.size() != finger.foci.size();
    placements.push_back(std::move(placement));
  }
  show_schedule(picture, schedule, placements);
}

void show_live_slot(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, std::uint64_t slot) {
  const session::Plan& plan = snapshot.plan;
  show_slot(picture, plan.schedule, slot);
  const std::size_t transducers = scene.layout.transducers.size();
  const bool whole = plan.drives.size() == plan.cycle * transducers;  // not so where it is of another array
  if (plan.schedule.voice_count == 0 || plan.cycle == 0 || picture.transducers.empty() || !whole) {
    picture.driven = false;
    return;
  }
  show_drive(picture, plan.drive(slot, transducers));
}

std::vector<geometry::SceneMesh> meshes_of(const LiveScene& scene, const std::vector<Transform>& poses) {
  std::vector<geometry::SceneMesh> meshes = scene.meshes;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::size_t solid = scene.picture.solids[i].solid;
    if (solid >= poses.size()) continue;
    for (Vec3& p : meshes[i].mesh.positions)
      p = transform_point(poses[solid], p);
  }
  return meshes;
}

}  // namespace palpa::viewer
