#include "setup/tasks/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <numbers>
#include <utility>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "geometry/files/stl.hpp"
#include "geometry/gltf/write.hpp"
#include "line/values.hpp"
#include "sensing/target.hpp"
#include "setup/options/target_mount.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::setup {
namespace {

constexpr std::uint64_t default_frames = 30, most_frames = 100;
constexpr double degree = std::numbers::pi / 180;
/// More than any camera's noise within a metre.
constexpr double usual_rms_m = 1e-3;

std::uint64_t frames_of(const CalibrateTask& task) {
  return task.frames == 0 ? default_frames : task.frames;
}

std::string source_of(const StillTask& task) {
  return task.source.empty() ? "synthetic" : task.source;
}

/// If the target or the camera has another scale, the camera's pose is wrong although the distances are small.
void warn_of_scale(const CalibratedCamera& camera, double depth_unit_m) {
  const sensing::FoundTarget& found = camera.found;
  if (!sensing::scale_is_off(found)) return;
  log::warning(fmt::format(
      "camera \"{}\": it sees the target {:.1f} % {} than it is, {:.1f} mm across the plate; either the print or the "
      "camera's scale is off: measure the plate, which should be 130.0 mm wide; if the print is right, the camera "
      "needs another depth_unit_m (such as {:.4g}) or its own calibration; until then, the pose is off by millimetres",
      camera.name, 100 * std::abs(found.scale - 1), found.scale > 1 ? "larger" : "smaller",
      1e3 * std::abs(found.scale - 1) * 2 * sensing::TargetSize::plate_half, depth_unit_m / found.scale));
}

void warn_of_distance(const CalibratedCamera& camera) {
  const double rms_m = camera.found.fit.rms_m;
  if (!(rms_m > usual_rms_m)) return;
  log::warning(
      fmt::format("camera \"{}\": its points lie {:.1f} mm (rms) from the target: was it printed in millimetres, and "
                  "flat? is depth_unit_m right?",
                  camera.name, rms_m * 1e3));
}

}  // namespace

void check(const StillTask& task) {
  refuse_tracker(source_of(task));
  if (task.noise_free && !source_of(task).starts_with("synthetic"))
    throw bad_usage("--noise-free goes with --source synthetic");
}

std::unique_ptr<sensing::DepthSource> open_still_source(const StillTask& task, const PosedRig& posed,
                                                        std::span<const session::SourceKind> sources,
                                                        const std::optional<Transform>& T_world_target) {
  std::vector<session::SourceKind> kinds(sources.begin(), sources.end());
  kinds.push_back(rehearsal(T_world_target));
  const geometry::Mesh boards = array::board_mesh(posed.layout);
  return session::open_source(source_of(task), with_builtin(kinds),
                              {.cameras = posed.rig.cameras,
                               .occluders = boards,
                               .default_skin = {},
                               .noise = !task.noise_free,
                               .seed = task.seed,
                               .paced = false,
                               .rig = posed.rig.file});
}

Transform pose_of_target(const TargetPlace& place, const PlacedLayout& placed) {
  const TargetMount mount = target_mount(placed.layout);
  Vec3 origin(mount.T_layout_target[3]);
  if (!place.at.empty()) {
    const auto [x, y, z] = line::parse_point("--at", place.at);
    origin = {x, y, z};
  }
  return placed.T_world_layout * moved_mount(mount, origin, place.turn_deg * degree);
}

void check(const CalibrateTask& task) {
  if (frames_of(task) > most_frames)
    throw bad_usage(fmt::format("--frames {}: at most {} are taken together", frames_of(task), most_frames));
  check(static_cast<const StillTask&>(task));
}

void add_pose(JsonWriter& json, const char* name, const Transform& T) {
  json.key(name).begin_array();
  for (int row = 0; row < 4; ++row)
    json.value(std::vector<double>{T[0][row], T[1][row], T[2][row], T[3][row]});
  json.end_array();
}

std::string to_json(const CalibrateResult& result) {
  JsonWriter json;
  json.begin_object().member("frames", result.frames);
  add_pose(json, "T_world_target", result.T_world_target);
  json.key("cameras").begin_array(JsonWriter::Style::block);
  for (const CalibratedCamera& camera : result.cameras) {
    const geometry::MeshFitted& fit = camera.found.fit;
    json.begin_object(JsonWriter::Style::line).member("name", camera.name).member("points", fit.points);
    json.member("rms_m", fit.rms_m).member("p95_m", fit.p95_m).member("hold", fit.hold);
    json.member("agreement", camera.found.agreement);
    json.member("scale", camera.found.scale).member("scale_deviation", camera.found.scale_deviation);
    json.member("deviation_m", fit.deviation_m).member("deviation_rad", fit.deviation_rad);
    json.member("moved_m", camera.moved_m).member("turned_rad", camera.turned_rad);
    add_pose(json, "T_world_camera", camera.T_world_camera);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

CalibrateResult calibrate(const CalibrateTask& task, std::span<const session::SourceKind> sources,
                          const CalibrateWatch& watch) {
  check(task);
  PosedRig posed = load_posed_rig(task.rig);
  CalibrateResult result;
  result.T_world_target = pose_of_target(task.target, load_placed_layout(task.rig));
  const auto source = open_still_source(task, posed, sources, result.T_world_target);
  if (watch.opened) watch.opened(frames_of(task));
  const std::vector<sensing::StillFrames> seen =
      collect_still_frames(*source, frames_of(task), [&](std::uint64_t done) {
        result.frames = done;
        if (watch.taken) watch.taken(done);
      });
  if (watch.all_taken) watch.all_taken();
  result.cameras = calibrate_cameras(posed.rig.cameras, source->cameras(), seen, result.T_world_target, posed.rig.file);
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    posed.rig.cameras[i].T_world_camera = result.cameras[i].T_world_camera;
    posed.rig.cameras[i].residual_m = result.cameras[i].found.fit.rms_m;
    warn_of_scale(result.cameras[i], source->cameras()[i].depth_unit_m);
    warn_of_distance(result.cameras[i]);
  }
  result.rig = rig_to_write(posed, task.rig);
  return result;
}

geometry::Mesh target_to_print(const array::Layout& layout) {
  return sensing::make_target(target_mount(layout).holes);
}

geometry::Mesh target_in_world(const TargetPlace& place, const PlacedLayout& placed) {
  geometry::Mesh mesh = target_to_print(placed.layout);
  const Transform T_world_target = pose_of_target(place, placed);
  for (Vec3& p : mesh.positions)
    p = transform_point(T_world_target, p);
  return mesh;
}

void check_target_file(const std::string& file, const TargetPlace& place) {
  const std::string kind = std::filesystem::path(file).extension();
  if (kind != ".stl" && kind != ".glb") throw bad_usage("--target " + file + ": give a file that ends in .stl or .glb");
  if (kind == ".stl" && (!place.at.empty() || place.turn_deg != 0))
    throw bad_usage(
        "--at and --turn place a model in the world, so they go with .glb: a printer's .stl lies as it is printed");
}

void write_target(const std::string& file, const TargetPlace& place, const PlacedLayout& placed) {
  if (file.ends_with(".stl")) return geometry::write_stl(file, target_to_print(placed.layout));
  const geometry::SceneMesh node{"target", target_in_world(place, placed)};
  geometry::write_glb(file, std::span(&node, 1));
}

sensing::Rig rig_to_write(const PosedRig& posed, const RigOptions& options) {
  sensing::Rig rig = posed.rig;
  if (options.layout.empty()) return rig;
  const std::vector<std::string> known = array::layout_names();
  const bool built_in = std::ranges::find(known, options.layout) != known.end();
  rig.array = {built_in ? options.layout : std::filesystem::absolute(options.layout).string(), {}, {}};
  return rig;
}

sensing::Rig nudged_rig(const PosedRig& posed, const RigOptions& options, const std::string& name, const Vec3& offset) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(offset[axis]) <= farthest_nudge_m) continue;
    throw bad_usage(fmt::format("{}: {:g} mm along {} is more than a nudge, at most {:g} mm: correct the rig instead",
                                name, offset[axis] * 1e3, "xyz"[axis], farthest_nudge_m * 1e3));
  }
  sensing::Rig rig = rig_to_write(posed, options);
  rig.array->T_world_layout = glm::translate(Transform(1.0), -offset) * posed.T_world_layout;
  return rig;
}

void write_rig(const std::string& file, const sensing::Rig& rig) {
  write_file(file, "# By palpa calibrate.\n\n" + sensing::to_toml(rig));
}

}  // namespace palpa::setup
