#include "viewer/show.hpp"

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "geometry/ply.hpp"
#include "sensing/rig.hpp"
#include "sensing/skin_twin.hpp"
#include "session/overrides.hpp"
#include "setup/load.hpp"
#include "setup/touch_run.hpp"
#include "setup/touch_schedule.hpp"

namespace palpa::viewer {
namespace {

/// Depth images show far more than the hand: only what lies this near the solids is drawn.
constexpr double skin_reach = 0.12;

std::vector<sensing::SkinPoint> points_near(const setup::TouchInput& input) {
  if (input.cameras.empty()) return input.points;
  Box box;
  for (const geometry::Solid& solid : input.solids) {
    box.add(solid.bounds.low - Vec3(skin_reach));
    box.add(solid.bounds.high + Vec3(skin_reach));
  }
  return sensing::find_skin(input.cameras, input.frames, box);
}

setup::TouchInput load_scene_alone(const setup::TouchInputOptions& options) {
  setup::TouchInput input;
  input.solids = setup::load_solids(options.scene, options.gltf_scene, options.solids);
  return input;
}

}  // namespace

Show::Show(const Options& options) : drive_options_(setup::drive_options(options.drive)) {
  picture_.title = options.title;
  picture_.dark = options.dark;
  picture_.legend = !options.no_legend;
  picture_.grid = !options.no_grid;
  if (!options.input.scene.empty()) load_objects(options);
  if (!options.skin.empty()) load_skin_surface(options);
  load_array(options);
  go_to(options.slot);
}

void Show::load_objects(const Options& options) {
  const bool touched = !options.input.points.empty() || !options.input.depths.empty();
  const setup::TouchInput input = touched ? setup::load_touch_input(options.input) : load_scene_alone(options.input);
  show_solids(picture_, input.solids);
  if (!touched) return;
  setup::StageTimes times;
  const touch::Parameters& parameters = options.touch.parameters;
  session::check_overrides(options.input.scene, input.solids, parameters, setup::voice_options(options.touch));
  const touch::Touch touch = options.common.backend == setup::Backend::cpu
                                 ? setup::touch_on_cpu(input, parameters, times)
                                 : setup::touch_on_gpu(setup::device_options(options.common), input, parameters, times);
  show_touch(picture_, input.solids, points_near(input), touch);
  const std::vector<setup::FingerSchedule> fingers =
      setup::schedule_fingers(touch, input.solids, options.touch, options.felt);
  schedule_ = setup::make_schedule(touch, input.solids, fingers, options.touch);
  std::vector<touch::Placement> placements;
  placements.reserve(fingers.size());
  for (const setup::FingerSchedule& finger : fingers)
    placements.push_back(finger.placement);
  show_schedule(picture_, schedule_, placements);
  if (options.felt.spectrum) show_spectra(picture_, setup::spectra_of(schedule_, options.felt));
  if (options.show_cameras) show_cameras(picture_, input.cameras);
}

void Show::load_skin_surface(const Options& options) {
  const geometry::Ply ply = geometry::read_ply(options.skin);
  if (ply.triangles.empty())
    throw bad_input(options.skin, "has no faces; --skin wants a mesh, --points takes points alone");
  geometry::Mesh mesh = geometry::weld({ply.positions, ply.triangles});
  if (options.input.penetration_m && !mesh.positions.empty()) {
    double top = -1e300, lowest = 1e300;
    for (const Surface& solid : picture_.solids)
      top = std::max(top, geometry::bounds(solid.mesh).high.y);
    for (const Vec3& p : mesh.positions)
      lowest = std::min(lowest, p.y);
    for (Vec3& p : mesh.positions)
      p.y += top - *options.input.penetration_m - lowest;
  }
  picture_.skin = Surface{std::filesystem::path(options.skin).stem().string(), std::move(mesh)};
}

void Show::load_array(const Options& options) {
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
  layout_ = array::transformed(layout, pose.value_or(layout.default_T_world_layout));
  show_array(picture_, layout_);
}

bool Show::changes() const {
  return std::any_of(picture_.fingers.begin(), picture_.fingers.end(),
                     [](const FingerMarks& finger) { return finger.foci.size() > 1; });
}

void Show::go_to(std::uint64_t slot) {
  if (schedule_.voice_count == 0) return;
  show_slot(picture_, schedule_, slot);
  if (picture_.transducers.empty()) return;
  array::foci_of_slot(schedule_, slot, foci_);
  drive_.resize(layout_.transducers.size());
  array::drive_for(layout_, foci_, drive_options_, drive_, drive_scratch_);
  show_drive(picture_, drive_);
}

}  // namespace palpa::viewer
