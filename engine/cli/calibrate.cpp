#include "cli/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "array/board_mesh.hpp"
#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "cli/commands.hpp"
#include "geometry/files/stl.hpp"
#include "geometry/gltf/write.hpp"
#include "sensing/target.hpp"
#include "session/links/sources.hpp"
#include "setup/calibration.hpp"
#include "setup/frames.hpp"
#include "setup/progress.hpp"
#include "setup/target_mount.hpp"
#include "setup/values.hpp"

namespace palpa::cli {
namespace {

constexpr std::uint64_t usual_frames = 30, most_frames = 100;
constexpr double degree = std::numbers::pi / 180;
/// More than that is no camera's noise within a metre.
constexpr double usual_rms_m = 1e-3;

void add_options(CLI::App& app, CalibrateCommand& o) {
  const setup::Group target(app, "The target");
  target.text("--target", o.target, "FILE",
              "write the model, .stl for a printer (millimetres, as it lies) or .glb for a viewer (the world, on "
              "its mount), and do no more");
  target.point("--at", o.at,
               "where the middle of the target's underside is, in the array's frame [its mount on the layout]");
  target.number("--turn", o.turn_deg, {-360, 360}, "DEGREES",
                "of the target about its own z, from above counter-clockwise");
  const setup::Group frames(app, "What is seen, and where it goes");
  frames.text("--source", o.source, "SOURCE",
              "synthetic[:MESH] (a rehearsal), recording:DIR, v4l2:/dev/videoN[,...], realsense:SERIAL[,...] or "
              "bag:FILE [a rehearsal]");
  add_allow_outside(frames, o.common);
  frames.integer("--frames", o.frames, 0, std::uint64_t{1} << 62,
                 "how many are taken together, 0: 30; with --nudge when to stop, 0: never");
  frames.flag("--noise-free", o.noise_free, "synthetic frames without the sensor's noise");
  frames.text("--out", o.out, "FILE", "write the rig with what was found; another file than --rig");
  setup::add_rig_options(app, o.rig);
  add_nudge_options(app, o);
}

/// In the world.
Transform pose_of_target(const CalibrateCommand& o, const setup::PlacedLayout& placed) {
  const setup::TargetMount mount = setup::target_mount(placed.layout);
  Vec3 origin(mount.T_layout_target[3]);
  if (!o.at.empty()) {
    const auto [x, y, z] = setup::parse_point("--at", o.at);
    origin = {x, y, z};
  }
  return placed.T_world_layout * setup::moved_mount(mount, origin, o.turn_deg * degree);
}

void write_target(const CalibrateCommand& o) {
  const std::string kind = std::filesystem::path(o.target).extension();
  if (kind != ".stl" && kind != ".glb")
    throw bad_usage("--target " + o.target + ": give a file that ends in .stl or .glb");
  if (!o.out.empty() || o.nudge)
    throw bad_usage("--target writes the model and does no more: leave --out and --nudge out");
  refuse_nudge_options(o);
  if (!o.source.empty() || o.frames != 0 || o.noise_free || !o.common.json.empty()) {
    throw bad_usage(
        "--target writes the model and does no more: leave --source, --frames, --noise-free and --json out");
  }
  if (kind == ".stl" && (!o.at.empty() || o.turn_deg != 0))
    throw bad_usage(
        "--at and --turn place a model in the world, as .glb has it: a printer's .stl lies as it is printed");
  setup::refuse_gpu_options(o.common, "palpa calibrate --target uses no GPU");
  const Outputs outputs({{"--target", o.target}});
  const setup::PlacedLayout placed = setup::load_placed_layout(o.rig);
  geometry::Mesh mesh = sensing::make_target(setup::target_mount(placed.layout).holes);
  if (kind == ".stl") {
    geometry::write_stl(o.target, mesh);
  } else {
    const Transform T_world_target = pose_of_target(o, placed);
    for (Vec3& p : mesh.positions)
      p = transform_point(T_world_target, p);
    const geometry::SceneMesh node{"target", mesh};
    geometry::write_glb(o.target, std::span(&node, 1));
  }
}

std::string to_json(const std::vector<setup::CalibratedCamera>& cameras, std::uint64_t frames,
                    const Transform& T_world_target) {
  JsonWriter json;
  const auto pose = [&](const char* name, const Transform& T) {
    json.key(name).begin_array();
    for (int row = 0; row < 4; ++row)
      json.value(std::vector<double>{T[0][row], T[1][row], T[2][row], T[3][row]});
    json.end_array();
  };
  json.begin_object().member("frames", frames);
  pose("T_world_target", T_world_target);
  json.key("cameras").begin_array(JsonWriter::Style::block);
  for (const setup::CalibratedCamera& camera : cameras) {
    const geometry::MeshFitted& fit = camera.found.fit;
    json.begin_object(JsonWriter::Style::line).member("name", camera.name).member("points", fit.points);
    json.member("rms_m", fit.rms_m).member("p95_m", fit.p95_m).member("hold", fit.hold);
    json.member("agreement", camera.found.agreement);
    json.member("scale", camera.found.scale).key("scale_deviation");
    std::isfinite(camera.found.scale_deviation) ? json.value(camera.found.scale_deviation) : json.null();
    json.member("deviation_m", fit.deviation_m).member("deviation_rad", fit.deviation_rad);
    json.member("moved_m", camera.moved_m).member("turned_rad", camera.turned_rad);
    pose("T_world_camera", camera.T_world_camera);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

/// A target or a camera of another scale puts the camera elsewhere with small distances all the same.
void warn_of_scale(const setup::CalibratedCamera& camera, double depth_unit_m) {
  const sensing::FoundTarget& found = camera.found;
  if (!sensing::scale_is_off(found)) return;
  log::warning(fmt::format(
      "camera \"{}\": it sees the target {:.1f} % {} than it is, {:.1f} mm across the plate; the print or the camera's "
      "measure is off, which look alike: measure the plate, which has 130.0 mm; if it is right, the camera needs "
      "another depth_unit_m (such as {:.4g}) or a calibration of its own; the pose is off by millimetres until then",
      camera.name, 100 * std::abs(found.scale - 1), found.scale > 1 ? "larger" : "smaller",
      1e3 * std::abs(found.scale - 1) * 2 * sensing::TargetSize::plate_half, depth_unit_m / found.scale));
}

std::string summary(const CalibrateCommand& o, const std::vector<setup::CalibratedCamera>& cameras) {
  std::string text;
  for (const setup::CalibratedCamera& camera : cameras) {
    const geometry::MeshFitted& fit = camera.found.fit;
    text += fmt::format("{}: {:.2f} mm rms, {:.2f} mm at 95 %, {} points; moved by {:.1f} mm and {:.2f} degrees\n",
                        camera.name, fit.rms_m * 1e3, fit.p95_m * 1e3, fit.points, camera.moved_m * 1e3,
                        camera.turned_rad / degree);
  }
  return text + (o.out.empty() ? "nothing written: give --out\n" : fmt::format("written to {}\n", o.out));
}

void find_poses(const Extensions& extensions, const CalibrateCommand& o) {
  const std::uint64_t frames = o.frames == 0 ? usual_frames : o.frames;
  if (frames > most_frames)
    throw bad_usage(fmt::format("--frames {}: at most {} are taken together", frames, most_frames));
  const std::string from = o.source.empty() ? "synthetic" : o.source;
  if (o.noise_free && !from.starts_with("synthetic")) throw bad_usage("--noise-free goes with --source synthetic");
  if (!o.out.empty() && o.source.empty())
    throw bad_usage("--out needs --source: a rehearsal finds the poses that the rig says already");
  setup::refuse_gpu_options(o.common, "palpa calibrate computes on the processor, but for --nudge");
  const Outputs outputs({{"--json", o.common.json}, {"--out", o.out}});
  setup::PosedRig posed = setup::load_posed_rig(o.rig);
  const Transform T_world_target = pose_of_target(o, setup::load_placed_layout(o.rig));
  std::vector<session::SourceKind> sources(extensions.sources);
  sources.push_back(setup::rehearsal(T_world_target));
  const geometry::Mesh boards = array::board_mesh(posed.layout);
  const auto source = session::open_source(from, setup::with_builtin(sources),
                                           {.cameras = posed.rig.cameras,
                                            .occluders = boards,
                                            .default_skin = {},
                                            .noise = !o.noise_free,
                                            .seed = o.common.seed,
                                            .paced = false,
                                            .rig = posed.rig.file});
  log::release_warnings();
  std::uint64_t taken = 0;
  std::vector<sensing::StillFrames> seen;
  {
    setup::Progress progress("frames", frames, o.common.quiet);
    seen = setup::collect_still_frames(*source, frames, [&](std::uint64_t done) { progress.set(taken = done); });
  }
  const std::vector<setup::CalibratedCamera> cameras =
      setup::calibrate_cameras(posed.rig.cameras, source->cameras(), seen, T_world_target, posed.rig.file);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    posed.rig.cameras[i].T_world_camera = cameras[i].T_world_camera;
    warn_of_scale(cameras[i], source->cameras()[i].depth_unit_m);
    if (const double rms_m = cameras[i].found.fit.rms_m; rms_m > usual_rms_m) {
      log::warning(
          fmt::format("camera \"{}\": its points lie {:.1f} mm from the target, rms: was it printed in "
                      "millimetres, and flat? is depth_unit_m right?",
                      cameras[i].name, rms_m * 1e3));
    }
  }
  if (!o.out.empty()) write_rig(o.out, rig_to_write(posed, o.rig));
  if (!o.common.json.empty()) write_file(o.common.json, to_json(cameras, taken, T_world_target));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary(o, cameras));
}

void run(const Extensions& extensions, const CalibrateCommand& o) {
  if (!o.target.empty()) return write_target(o);
  if (o.nudge) return run_nudge(extensions, o);
  refuse_nudge_options(o);
  find_poses(extensions, o);
}

}  // namespace

sensing::Rig rig_to_write(const setup::PosedRig& posed, const setup::RigOptions& options) {
  sensing::Rig rig = posed.rig;
  if (options.layout.empty()) return rig;
  const std::vector<std::string> known = array::layout_names();
  const bool built_in = std::ranges::find(known, options.layout) != known.end();
  rig.array = {built_in ? options.layout : std::filesystem::absolute(options.layout).string(), {}, {}};
  return rig;
}

void write_rig(const std::string& file, const sensing::Rig& rig) {
  write_file(file, "# By palpa calibrate.\n\n" + sensing::to_toml(rig));
}

void add_calibrate(Program& program) {
  const Extensions& extensions = program.extensions;
  add_subcommand<CalibrateCommand>(
      program,
      {"calibrate", "where the cameras are, from what they see of a printed target",
       "  palpa calibrate --target target.stl --layout openmpd\n"
       "  palpa calibrate --rig rig.toml --layout openmpd --source v4l2:/dev/video0,/dev/video4 --out calibrated.toml\n"
       "  palpa calibrate --nudge --rig calibrated.toml --source v4l2:/dev/video0,/dev/video4 --link openmpd:FT43NK5M "
       "--out nudged.toml"},
      add_options, [&extensions](const CalibrateCommand& o) { run(extensions, o); });
}

}  // namespace palpa::cli
