#include "cli/doctor_rig.hpp"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "base/error.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/rig_toml.hpp"
#include "session/links/sources.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/tracker.hpp"

namespace palpa::cli {
namespace {

CamerasThere cameras_of(const Extensions& extensions, const std::string& source) {
  const std::vector<session::SourceKind> kinds = setup::with_builtin(extensions.sources);
  if (!session::ends_by_itself(source, kinds) || source.starts_with("synthetic") || setup::is_tracker(source)) {
    throw bad_usage(fmt::format(
        "--source {}: give recording:DIR or bag:FILE, or leave --source out for the cameras that are plugged in",
        source));
  }
  std::vector<sensing::Camera> unknown(1);
  unknown[0].name = "camera";
  const geometry::Mesh nothing;
  const auto opened = session::open_source(
      source, kinds, {.cameras = unknown, .occluders = nothing, .default_skin = {}, .paced = false});
  CamerasThere there{.source = source, .cameras = {}, .problem = {}};
  for (const sensing::Camera& camera : opened->cameras()) {
    there.cameras.push_back({camera, "size, lens and depth unit are those of the recording"});
    there.cameras.back().camera.T_world_camera = Transform(1.0);
  }
  return there;
}

}  // namespace

CamerasThere cameras_there(const Extensions& extensions, const std::string& source) {
  if (!source.empty()) return cameras_of(extensions, source);
  CamerasThere there = extensions.cameras ? extensions.cameras() : CamerasThere{};
  if (there.cameras.empty()) {
    throw failure(
        fmt::format("--write-rig: no depth camera can be opened{}", there.problem.empty() ? "" : ": " + there.problem));
  }
  return there;
}

std::string rig_of(const CamerasThere& there, const std::string& file) {
  std::string text = fmt::format(
      "# By palpa doctor: cameras in the order of --source {0}\n"
      "#\n"
      "# T_world_camera is not known yet: each camera stands at the world's origin and looks along +z. To find the\n"
      "# poses, mount the printed target on the array and write another rig (LAYOUT is your array, such as openmpd):\n"
      "#   palpa calibrate --target target.stl --layout LAYOUT\n"
      "#   palpa calibrate --rig {1} --layout LAYOUT --source {0} --out calibrated.toml\n",
      there.source, file);
  for (const CameraThere& one : there.cameras)
    text += fmt::format("\n# {}\n{}", one.note, sensing::to_toml(one.camera));
  return text;
}

}  // namespace palpa::cli
