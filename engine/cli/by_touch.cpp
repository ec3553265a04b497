// `palpa calibrate --by-touch`: the poses of cameras from foci that a person touches.
#include <fmt/format.h>

#include <numbers>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "cli/calibrate.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/load.hpp"
#include "setup/sessions/tracker.hpp"
#include "setup/tasks/calibrate.hpp"
#include "setup/tasks/register_cameras.hpp"

namespace palpa::cli {
namespace {

/// How far a rehearsal's finger is from each focus: people find one to 3 mm.
constexpr double rehearsed_off_m = 3e-3;

std::string to_json(const std::vector<setup::TouchedCamera>& cameras, bool saved) {
  JsonWriter json;
  json.begin_object().member("saved", saved).key("cameras").begin_array(JsonWriter::Style::block);
  for (const setup::TouchedCamera& camera : cameras) {
    json.begin_object(JsonWriter::Style::line).member("name", camera.name);
    json.member("touches", static_cast<std::uint64_t>(camera.seen)).member("residual_m", camera.residual_m);
    json.member("moved_m", camera.moved_m).member("turned_rad", camera.turned_rad);
    setup::add_pose(json, "T_world_camera", camera.T_world_camera);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

std::string summary_of(const std::vector<setup::TouchedCamera>& cameras, const std::string& out) {
  std::string text;
  for (const setup::TouchedCamera& camera : cameras) {
    text +=
        fmt::format("{}: {} touches, {:.1f} mm rms; moved by {:.1f} mm and {:.1f} degrees\n", camera.name, camera.seen,
                    camera.residual_m * 1e3, camera.moved_m * 1e3, camera.turned_rad * 180 / std::numbers::pi);
  }
  return text.empty() ? "nothing is saved\n"
                      : text + fmt::format("written to {}; palpa calibrate --nudge --rig {} refines it\n", out, out);
}

}  // namespace

void run_by_touch(const Extensions& extensions, const CalibrateCommand& given) {
  CalibrateCommand o = given;
  check_keys(o, "--by-touch");
  if (o.source.empty()) o.source = "synthetic";
  if (setup::is_tracker(o.source))
    throw bad_usage("--by-touch goes with cameras; with --source joints, --nudge registers a tracker");
  if (o.noise_free && o.source != "synthetic") throw bad_usage("--noise-free goes with --source synthetic");
  o.scene = setup::find_asset("cube.glb");
  o.touch.method.method = touch::Method::single_focus;
  o.every_frame = !o.keys.empty();  // a script takes as many frames as it has keys
  o.noise_free = false;             // the session's source is no synthetic one
  o.source = "joints:" + o.source;
  setup::check(o);
  const std::vector<session::LinkKind> links = setup::with_builtin(extensions.links);
  const Outputs outputs(
      {{"--json", o.common.json}, {"--out", o.out}, {"--link", session::file_of_link(o.link, links)}});
  setup::take_layout_of_link(o.rig, o.link, links);
  const setup::PosedRig posed = setup::load_posed_rig(o.rig);
  setup::CameraTouches touches(posed.layout);
  std::vector<session::SourceKind> cameras = extensions.sources, sources = extensions.sources;
  cameras.push_back(touches.rehearsal(rehearsed_off_m, !given.noise_free));
  sources.push_back(touches.source(cameras));
  o.own_method = touches.method();
  const KeysEnd end = run_with_keys(o, sources, extensions.links, "--by-touch", &touches);
  std::vector<setup::TouchedCamera> found;
  if (end.saves) {
    found = touches.result(posed.rig.cameras);
    sensing::Rig rig = setup::rig_to_write(posed, o.rig);
    for (std::size_t i = 0; i < found.size(); ++i) {
      rig.cameras[i].T_world_camera = found[i].T_world_camera;
      rig.cameras[i].residual_m = found[i].residual_m;
    }
    setup::write_rig(o.out, rig);
  }
  if (!o.common.json.empty()) write_file(o.common.json, to_json(found, end.saves));
  if (setup::shows_summary(o.common, outputs)) write_file("-", summary_of(found, o.out));
  if (end.fault) throw Error(*end.fault);
}

}  // namespace palpa::cli
