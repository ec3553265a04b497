#include "cli/doctor_rig.hpp"

#include <fmt/format.h>

#include <memory>
#include <vector>

#include "base/error.hpp"
#include "base/text.hpp"
#include "geometry/mesh/mesh.hpp"
#include "sensing/find_target.hpp"
#include "sensing/rig.hpp"
#include "sensing/rig_toml.hpp"
#include "session/links/sources.hpp"
#include "setup/sessions/frames.hpp"
#include "setup/sessions/tracker.hpp"
#include "setup/tasks/rig_check.hpp"

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

/// A placement with less on some object is poor: half of the front of a fingertip.
constexpr double least_contacts = 0.25;

/// What is seen of a fingertip on each object, for people and for --json.
DoctorItem contacts_item(const std::string& name, const setup::ContactShares& shares) {
  DoctorItem item;
  item.facts.emplace_back("name", name);
  std::string each;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    each += fmt::format("{}{} {:.0f} %", i == 0 ? "" : ", ", setup::checked_objects[i], 100 * shares[i]);
    item.facts.emplace_back(setup::checked_objects[i], shares[i]);
  }
  item.title = fmt::format("{}: {:.0f} % of a fingertip's contacts ({})", name, 100 * setup::mean_of(shares), each);
  item.ok = setup::least_of(shares) >= least_contacts;
  return item;
}

DoctorItem camera_item(const setup::CameraCheck& camera) {
  DoctorItem item = contacts_item(camera.name, camera.contacts);
  item.facts.emplace_back("hold", camera.hold);
  item.facts.emplace_back("board", camera.board_share);
  item.title += camera.board_share > 0 ? fmt::format("; boards in {:.1f} % of the image", 100 * camera.board_share)
                                       : "; no board in the image";
  if (camera.target_fault.empty()) item.title += fmt::format("; the target with hold {:.2f}", camera.hold);
  if (!item.ok) {
    item.advice =
        "sees too little of where a fingertip touches: it needs to be 0.28 m or more away, about as high as "
        "the object, and aimed at its top (docs/cameras.md)";
  }
  if (!camera.target_fault.empty()) {
    item.ok = false;
    item.advice += (item.advice.empty() ? "palpa calibrate: " : "; palpa calibrate: ") + camera.target_fault;
  }
  return item;
}

std::string text_of(const CameraThere& one) {
  return fmt::format("\n# {}\n{}", one.note, sensing::to_toml(one.camera));
}

std::string rig_like(const CamerasThere& there, const std::string& file, const std::string& like) {
  const sensing::Rig placed = sensing::load_rig(like);
  if (!placed.array) throw bad_input(like, "has no [array], which --write-rig takes from it");
  if (placed.cameras.size() != there.cameras.size()) {
    throw bad_input(like, fmt::format("has {}, but {} are there: --write-rig takes the poses from it, one for each",
                                      counted(placed.cameras.size(), "camera"), there.cameras.size()));
  }
  std::string text = fmt::format(
      "# By palpa doctor: cameras in the order of --source {0}\n"
      "#\n"
      "# The array and the poses are those of {2}: put everything there. Then\n"
      "#   palpa calibrate --rig {1} --source {0} --out calibrated.toml\n"
      "# with the printed target on the array, or with --by-touch, finds the true poses.\n",
      there.source, file, like);
  for (std::size_t i = 0; i < placed.cameras.size(); ++i) {
    CameraThere one = there.cameras[i];
    one.camera.T_world_camera = placed.cameras[i].T_world_camera;
    text += text_of(one);
  }
  return text + "\n" + sensing::to_toml(sensing::Rig{.array = placed.array});
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

std::string rig_of(const CamerasThere& there, const std::string& file, const std::string& like) {
  if (!like.empty()) return rig_like(there, file, like);
  std::string text = fmt::format(
      "# By palpa doctor: cameras in the order of --source {0}\n"
      "#\n"
      "# T_world_camera is not known yet: each camera stands at the world's origin and looks along +z. To find the\n"
      "# poses, mount the printed target on the array and write another rig (LAYOUT is your array, such as openmpd):\n"
      "#   palpa calibrate --target target.stl --layout LAYOUT\n"
      "#   palpa calibrate --rig {1} --layout LAYOUT --source {0} --out calibrated.toml\n",
      there.source, file);
  for (const CameraThere& one : there.cameras)
    text += text_of(one);
  return text;
}

DoctorSection look_at_rig(const setup::RigOptions& options) {
  const setup::RigCheck check = setup::check_rig(options);
  DoctorSection section{"rig", "What the cameras of " + options.rig + " will see, by simulation", {}, {}};
  for (const setup::CameraCheck& camera : check.cameras)
    section.items.push_back(camera_item(camera));
  if (check.cameras.size() > 1) section.items.push_back(contacts_item("all cameras together", check.contacts));
  return section;
}

}  // namespace palpa::cli
