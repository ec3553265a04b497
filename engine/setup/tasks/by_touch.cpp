#include "setup/tasks/by_touch.hpp"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/log.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/tracker.hpp"
#include "setup/tasks/calibrate.hpp"

namespace palpa::setup {
namespace {

/// How far a rehearsal's finger is from each focus: people find one to 3 mm.
constexpr double rehearsed_off_m = 3e-3;

std::string to_json(const std::vector<TouchedCamera>& cameras, bool saved) {
  JsonWriter json;
  json.begin_object().member("saved", saved).key("cameras").begin_array(JsonWriter::Style::block);
  for (const TouchedCamera& camera : cameras) {
    json.begin_object(JsonWriter::Style::line).member("name", camera.name);
    json.member("touches", static_cast<std::uint64_t>(camera.seen)).member("residual_m", camera.residual_m);
    json.member("moved_m", camera.moved_m).member("turned_rad", camera.turned_rad);
    add_pose(json, "T_world_camera", camera.T_world_camera);
    json.end_object();
  }
  json.end_array().end_object();
  return json.take();
}

void warn_of_wrong_touch(const TouchedCamera& camera) {
  if (!camera.wrong) return;
  log::warning(fmt::format(
      "camera \"{}\": the touch of focus {} is left out: it was {:.0f} mm from where the others say; if there are more "
      "such, begin again",
      camera.name, camera.wrong->focus + 1, camera.wrong->off_m * 1e3));
}

std::string summary_of(const std::vector<TouchedCamera>& cameras, const std::string& out) {
  std::string text;
  for (const TouchedCamera& camera : cameras) {
    text +=
        fmt::format("{}: {} touches, {:.1f} mm rms; moved by {:.1f} mm and {:.1f} degrees\n", camera.name, camera.seen,
                    camera.residual_m * 1e3, camera.moved_m * 1e3, camera.turned_rad * 180 / std::numbers::pi);
  }
  return text.empty() ? "nothing is saved\n"
                      : text + fmt::format("written to {}; palpa calibrate --nudge --rig {} refines it\n", out, out);
}

PosedRig posed_for(LiveOptions& options, std::span<const session::LinkKind> links) {
  if (is_tracker(options.source))
    throw bad_usage("--by-touch goes with cameras; with --source joints, palpa calibrate --nudge registers a tracker");
  if (options.noise_free && options.source != "synthetic") throw bad_usage("--noise-free goes with --source synthetic");
  take_layout_of_link(options.rig, options.link, links);
  return load_posed_rig(options.rig);
}

}  // namespace

ByTouch::ByTouch(LiveOptions& options, std::string out, std::span<const session::SourceKind> kinds,
                 std::span<const session::LinkKind> links)
    : out_(std::move(out)),
      posed_(posed_for(options, with_builtin(links))),
      touches_(posed_.layout),
      sources_(kinds.begin(), kinds.end()) {
  rig_ = options.rig;
  std::vector<session::SourceKind> cameras = sources_;
  cameras.push_back(touches_.rehearsal(rehearsed_off_m, !options.noise_free));
  sources_.push_back(touches_.source(std::move(cameras)));
  options.scene = find_asset("cube.glb");
  options.touch.method.method = touch::Method::single_focus;
  options.noise_free = false;  // the session's source is no synthetic one
  options.source = "joints:" + options.source;
  options.own_method = touches_.method();
}

std::string ByTouch::finish(bool saves, const std::string& json) const {
  std::vector<TouchedCamera> found;
  if (saves) {
    found = touches_.result(posed_.rig.cameras);
    sensing::Rig rig = rig_to_write(posed_, rig_);
    for (std::size_t i = 0; i < found.size(); ++i) {
      rig.cameras[i].T_world_camera = found[i].T_world_camera;
      rig.cameras[i].residual_m = found[i].residual_m;
      warn_of_wrong_touch(found[i]);
    }
    write_rig(out_, rig);
  }
  if (!json.empty()) write_file(json, to_json(found, saves));
  return summary_of(found, out_);
}

}  // namespace palpa::setup
