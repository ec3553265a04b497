#include "viewer/app/shown_touch.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include "array/plausible.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/nearest.hpp"
#include "sensing/rig.hpp"
#include "sensing/skin_twin.hpp"
#include "setup/options/warnings.hpp"
#include "setup/process/progress.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/near_skin.hpp"
#include "setup/sessions/play.hpp"
#include "setup/sessions/touch_run.hpp"
#include "setup/sessions/touch_schedule.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::viewer {
namespace {

/// The focus leaves a trail as long as one turn of the fastest brush, at most.
constexpr std::uint64_t trail = 16;

sensation::PatternSensation loaded(const std::string& name, std::span<const std::string> parameters) {
  sensation::Pattern pattern = setup::load_sensation(name);
  const auto given = setup::parameters_of(parameters, pattern);
  return sensation::PatternSensation(std::move(pattern), given);
}

std::vector<sensing::SkinPoint> points_near(const setup::TouchInput& input, std::span<const geometry::Solid> solids) {
  if (input.cameras.empty()) return input.points;
  Box box;
  for (const geometry::Solid& solid : solids) {
    box.add(solid.bounds.low - Vec3(setup::near_skin_m));
    box.add(solid.bounds.high + Vec3(setup::near_skin_m));
  }
  return sensing::find_skin(input.cameras, input.frames, box);
}

}  // namespace

ShownSensation::ShownSensation(const std::string& name, std::span<const std::string> parameters,
                               const array::Layout& layout, const Transform& T_world_array)
    : name_(std::filesystem::path(name).stem().string()),
      sensation_(loaded(name, parameters)),
      slot_s_(setup::usual_slot(setup::playable(sensation_.fastest_hz(), name), 1 / layout.frequency_hz)),
      T_world_array_(T_world_array),
      watch_(layout) {}

void ShownSensation::evaluate(std::uint64_t slot) {
  std::vector<double> times;
  for (std::uint64_t s = points_.size(); s <= slot && s < setup::most_offline_slots && !whole_; ++s)
    times.push_back(static_cast<double>(s) * slot_s_);
  const auto known = static_cast<std::ptrdiff_t>(points_.size());
  sensation_.points(times, state_, points_);
  const auto stop = std::ranges::find(points_.begin() + known, points_.end(), true, &sensation::Point::stop);
  whole_ = whole_ || stop != points_.end() || points_.size() >= setup::most_offline_slots;
  points_.erase(stop, points_.end());
  for (auto point = points_.begin() + std::min(known, std::ssize(points_)); point != points_.end(); ++point) {
    if (point->gain > 0 && !watch_.sounds(transform_point(T_world_array_, point->place_m))) point->gain = 0;
  }
  watch_.look();
  if (points_.empty()) points_.emplace_back();
}

array::SlotFocus ShownSensation::show(Picture& picture, std::uint64_t slot) {
  evaluate(slot);
  const std::uint64_t now = slot % points_.size();
  FingerMarks marks;
  for (std::uint64_t s = now - std::min(now, trail - 1); s <= now; ++s) {
    if (points_[s].gain == 0 && s != now) continue;
    const auto place = glm::vec3(transform_point(T_world_array_, points_[s].place_m));
    marks.foci.push_back({place, static_cast<std::uint32_t>(s), points_[s].gain > 0});
  }
  const sensation::Point& point = points_[now];
  if (point.gain > 0) marks.running = static_cast<std::uint32_t>(marks.foci.size() - 1);
  marks.sensation =
      fmt::format("{}: {:.4f} s, intensity {:.2f}", name_, static_cast<double>(now) * slot_s_, point.gain);
  picture.fingers = {std::move(marks)};
  const Vec3 place = transform_point(T_world_array_, point.place_m);
  return {.position = point.gain > 0 ? place : Vec3(0), .gain = static_cast<float>(point.gain)};
}

ShownTouch::ShownTouch(const ViewerOptions& options)
    : layout_(std::make_shared<const array::Layout>()),
      air_(setup::air(options.drive.medium, {})),
      spot_m_(options.touch.spot_m) {
  picture_.title = options.title;
  {
    const setup::Preparing preparing(options.common.quiet);
    load_array(options);
    drive_options_ = setup::drive_options(options.drive, *layout_, setup::solving_of(options.touch.method.method));
    if (!options.input.scene.empty()) load_objects(options);
  }
  if (!options.skin.empty() && !picture_.skin) load_skin_surface(options);
  go_to(options.slot);
}

void ShownTouch::load_objects(const ViewerOptions& options) {
  std::vector<geometry::Solid> solids =
      setup::load_solids(options.input.scene, options.input.gltf_scene, options.input.solids);
  show_solids(picture_, solids);
  if (options.input.points.empty() && options.input.depths.empty()) return;
  const setup::TouchInput input = setup::load_touch_input(options.input, solids);
  setup::StepTimes times;
  check(options.drive, solids);
  setup::TouchArray array{.layout = {}, .drive = drive_options_, .pressure_pa = options.drive.pressure_pa};
  const auto asks = [](const geometry::Solid& solid) { return solid.haptics.pressure_pa.has_value(); };
  const bool felt = options.felt.spectrum || options.touch.tune || !options.skin.empty();
  // Only what skin feels in time, and the pressures that are reached, depend on the array. Drives come slot by slot.
  if (felt || array.pressure_pa || std::ranges::any_of(solids, asks)) array.layout = *layout_;
  const setup::OneTouch one = setup::touch_once(options.common, options.touch, options.felt, options.input.scene,
                                                std::move(solids), input, std::move(array), times);
  show_skin(input, one.session.solids(), one.touch);
  show_cameras(picture_, input.cameras);
  show_depth(picture_, input.cameras, input.frames);
  schedule_ = one.session.schedule();
  if (!options.skin.empty() && !layout_->transducers.empty()) plan_ = one.session.plan();
  std::vector<touch::Placement> placements;
  for (const session::ScheduledFinger& finger : one.session.scheduler().fingers())
    placements.push_back(finger.placement);
  show_schedule(picture_, schedule_, placements);
  if (options.felt.spectrum) show_spectra(picture_, setup::spectra_of(one.session));
}

void ShownTouch::show_skin(const setup::TouchInput& input, std::span<const geometry::Solid> solids,
                           const touch::Touch& touch) {
  std::vector<sensing::SkinPoint> points = points_near(input, solids), flying;
  if (!input.cameras.empty()) {
    const sensing::RayTables rays = sensing::make_rays(input.cameras);
    const std::vector<touch::SightCamera> cameras = touch::sight_cameras(input.cameras, rays);
    touch::part_flying({cameras, rays, input.frames}, points, flying);
  }
  show_touch(picture_, solids, points, touch);
  for (const sensing::SkinPoint& point : flying)
    picture_.dropped_points.push_back(point.position);
  picture_.dropped_count = flying.size();
  picture_.skin_count = picture_.skin_points.size() + picture_.contacts.size();
  if (!picture_.fingers.empty()) return;
  const auto nearest = setup::nearest_skin(solids, input);
  picture_.untouched = why_untouched(
      picture_, nearest ? "the nearest skin is " + setup::place_of(*nearest, solids) : "there is no skin");
  log::warning("nothing touches: " + picture_.untouched);
}

/// Warns if most of the points are nowhere near the mesh: those of a hand with the mesh of a finger.
void ShownTouch::warn_of_other_skin(const ViewerOptions& options, const geometry::Mesh& skin) const {
  constexpr double far_m = 5e-3;
  constexpr std::size_t most = 2000;
  if (options.input.points.empty() || options.input.scene.empty()) return;
  std::vector<Vec3> points;
  for (const glm::vec3& point : picture_.skin_points)
    points.emplace_back(point);
  for (const ContactMark& contact : picture_.contacts)
    points.emplace_back(contact.position);
  const geometry::NearestTriangle surface(skin);
  const std::size_t step = 1 + points.size() / most;
  std::size_t looked = 0, far = 0;
  for (std::size_t i = 0; i < points.size(); i += step, ++looked)
    far += surface.distance(points[i], far_m) >= far_m ? 1 : 0;
  if (2 * far > looked)
    log::warning(
        fmt::format("--skin {} is not the surface of --points {}: {:.0f} % of the points are more than {:g} mm "
                    "from it",
                    options.skin, options.input.points, 100.0 * far / looked, far_m * 1e3));
}

void ShownTouch::load_skin_surface(const ViewerOptions& options) {
  const geometry::Ply ply = geometry::read_ply(options.skin);
  if (ply.triangles.empty())
    throw bad_input(options.skin, "has no faces; --skin needs a mesh, --points takes points without faces");
  geometry::Mesh mesh = geometry::weld({ply.positions, ply.triangles});
  if (options.input.penetration_m && !mesh.positions.empty()) {
    double top = -1e300, lowest = 1e300;
    for (const SurfaceMark& solid : picture_.solids)
      top = std::max(top, geometry::bounds(solid.mesh).high.y);
    for (const Vec3& p : mesh.positions)
      lowest = std::min(lowest, p.y);
    skin_lowered_m_ = top - *options.input.penetration_m - lowest;
    for (Vec3& p : mesh.positions)
      p.y += skin_lowered_m_;
  }
  warn_of_other_skin(options, mesh);
  picture_.skin = SurfaceMark{std::filesystem::path(options.skin).stem().string(), std::move(mesh)};
}

void ShownTouch::load_array(const ViewerOptions& options) {
  if (!options.sensation.empty()) {
    const setup::PlacedLayout placed = setup::load_placed_layout({.layout = options.layout});
    take_array(placed.layout, placed.T_world_layout);
    sensation_.emplace(options.sensation, options.parameters, *layout_, placed.T_world_layout);
    return;
  }
  std::string name = options.layout;
  std::optional<Transform> pose;
  if (name.empty() && !options.input.rig.empty()) {
    const sensing::Rig rig = sensing::load_rig(options.input.rig);
    if (rig.array) {
      name = rig.array->layout;
      pose = rig.array->T_world_layout;
    }
  }
  if (name.empty()) return;
  const array::Layout layout = array::load_layout(name);
  take_array(layout, pose.value_or(layout.default_T_world_layout));
}

void ShownTouch::take_array(const array::Layout& layout, const Transform& T_world_layout) {
  layout_ = std::make_shared<const array::Layout>(array::transformed(layout, T_world_layout));
  setup::warn_of_frequency(*layout_, air_.medium);
  show_array(picture_, *layout_);
}

void ShownTouch::show_field(FieldSlice& field, const SliceState& slice) {
  if (!drive_.empty()) field.show(picture_, slice, drive_);
}

Sounding ShownTouch::sounding() const {
  Sounding now;
  if (!layout_->transducers.empty()) now.layout = layout_;
  now.drive = drive_options_;
  now.air = air_;
  now.spot_m = spot_m_;
  if (schedule_.voice_count > 0) now.schedule = &schedule_;
  if (plan_) now.plan = &*plan_;
  now.slot = drive_;
  now.T_world_finger = glm::translate(Transform(1.0), Vec3(0, skin_lowered_m_, 0));
  return now;
}

void ShownTouch::go_to(std::uint64_t slot) {
  if (sensation_) {
    foci_ = {sensation_->show(picture_, slot)};
  } else if (schedule_.voice_count > 0) {
    show_slot(picture_, schedule_, slot);
    array::foci_of_slot(schedule_, slot, foci_);
  }
  if ((schedule_.voice_count == 0 && !sensation_) || picture_.transducers.empty()) return;
  drive_.resize(layout_->transducers.size());
  array::drive_for(*layout_, foci_, drive_options_, drive_, drive_scratch_);
  show_drive(picture_, drive_);
}

}  // namespace palpa::viewer
