#include "viewer/live/live_picture.hpp"

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "session/plan/voice.hpp"

namespace palpa::viewer {

void show_live(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, const Seen& seen, bool depth) {
  std::vector<geometry::Solid> named(scene.solid_names.size());
  for (std::size_t i = 0; i < named.size(); ++i)
    named[i].name = scene.solid_names[i];
  show_touch(picture, named, seen.skin.points, snapshot.touch);
  picture.skin_count = seen.skin.points.size();
  picture.untouched = why_untouched(picture, seen.untouched);
  picture.dropped_points.clear();
  for (const sensing::SkinPoint& point : seen.skin.leavings)
    picture.dropped_points.push_back(point.position);
  picture.dropped_count = picture.dropped_points.size();
  std::erase_if(picture.images, [](const ImageMark& image) { return image.layer == Layer::depth; });
  if (depth && !seen.images.frames.empty()) show_depth(picture, scene.cameras, seen.images.frames);

  const array::Schedule schedule = session::by_finger(snapshot.plan.schedule, snapshot.touch);
  std::vector<touch::Placement> placements;
  for (std::uint32_t f = 0; f < schedule.voice_count; ++f) {
    const touch::Finger& finger = snapshot.touch.fingers[f];
    const array::Voice& voice = schedule.voices[f];
    touch::Placement placement;
    placement.foci = finger.foci;
    placement.together = voice.foci_per_slot > 1;
    // If the method has its own foci, every focus has its place.
    placement.complete = finger.placed || voice.foci.size() != finger.foci.size();
    placements.push_back(std::move(placement));
  }
  show_schedule(picture, schedule, placements);
  for (std::uint32_t f = 0; f < schedule.voice_count && f < picture.fingers.size(); ++f) {
    std::vector<glm::vec3>& places = picture.fingers[f].seen;
    places.clear();
    if (schedule.voices[f].velocity == Vec3(0)) continue;
    for (std::size_t n = 0; n < placements[f].foci.size(); ++n) {
      if (placements[f].has(n)) places.push_back(placements[f].foci[n].position);
    }
  }
}

namespace {

/// Whether the plan plays something, and is for this array.
bool plays(const LiveScene& scene, const session::Plan& plan) {
  const std::size_t transducers = scene.layout.transducers.size();
  return plan.schedule.voice_count > 0 && transducers > 0 && plan.drives.size() == plan.listed() * transducers;
}

}  // namespace

std::span<const array::TransducerDrive> drive_of(const LiveScene& scene, const session::Plan& plan, std::uint64_t slot,
                                                 session::SlotScratch& scratch) {
  if (!plays(scene, plan)) return {};
  const session::OutputSetting setting{.layout = scene.layout, .drive = scene.drive, .slot_s = plan.schedule.slot_s};
  return session::drive_of_slot(plan, slot, plan.captured_s, setting, scratch);
}

void show_live_slot(Picture& picture, const LiveScene& scene, const Snapshot& snapshot, std::uint64_t slot,
                    session::SlotScratch& scratch) {
  show_slot(picture, session::by_finger(snapshot.plan.schedule, snapshot.touch), slot);
  const auto drive = drive_of(scene, snapshot.plan, slot, scratch);
  picture.driven = false;
  if (!picture.transducers.empty() && !drive.empty()) show_drive(picture, drive);
}

Sounding sounding_of(const std::shared_ptr<const LiveScene>& scene, const Snapshot& snapshot) {
  Sounding now;
  now.layout = std::shared_ptr<const array::Layout>(scene, &scene->layout);
  now.drive = scene->drive;
  now.air = scene->air;
  now.spot_m = scene->spot_m;
  if (!plays(*scene, snapshot.plan)) return now;
  now.schedule = &snapshot.plan.schedule;
  now.plan = &snapshot.plan;
  now.tip = tip_of(snapshot.touch);
  return now;
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
