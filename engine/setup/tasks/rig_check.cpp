#include "setup/tasks/rig_check.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <numeric>

#include "array/layouts/board_mesh.hpp"
#include "base/error.hpp"
#include "geometry/solid.hpp"
#include "sensing/find_target.hpp"
#include "sensing/synthetic.hpp"
#include "session/links/sources.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/calibration.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/calibrate.hpp"

namespace palpa::setup {
namespace {

constexpr double penetration_m = 3e-3, delta_m = 1.5e-3;
/// Half of the pixels that are seen at this cosine of incidence have no depth.
constexpr double least_cosine = (sensing::D415::grazing_all + sensing::D415::grazing_none) / 2;
/// A depth that is this much smaller belongs to something in front.
constexpr double in_front_m = 2e-3;
constexpr std::uint64_t frames_of_target = 30;

/// A part of the skin that touches an object.
struct Patch {
  Vec3 place{}, normal{};  ///< world
  double area = 0;
};

/// The finger in the object, and its triangles whose middles are in the object's shell.
struct Pressed {
  geometry::Mesh mesh;
  std::vector<Patch> contacts;
};

Pressed press(const geometry::Mesh& finger, const std::vector<geometry::Solid>& solids) {
  Pressed pressed{finger, {}};
  double top = -std::numeric_limits<double>::infinity();
  for (const geometry::Solid& solid : solids)
    top = std::max(top, solid.bounds.high.y);
  const double dy = top - penetration_m - geometry::bounds(finger).low.y;
  for (Vec3& position : pressed.mesh.positions)
    position.y += dy;
  for (const glm::uvec3& corners : pressed.mesh.triangles) {
    const Vec3 &a = pressed.mesh.positions[corners[0]], &b = pressed.mesh.positions[corners[1]],
               &c = pressed.mesh.positions[corners[2]];
    const Vec3 middle = (a + b + c) / 3.0, across = glm::cross(b - a, c - a);
    const auto touches = [&](const geometry::Solid& solid) {
      const double depth_m = geometry::depth(solid, middle);
      return depth_m > 0 && depth_m < delta_m;
    };
    if (std::ranges::any_of(solids, touches))
      pressed.contacts.push_back({middle, glm::normalize(across), glm::length(across) / 2});
  }
  return pressed;
}

/// Whether the camera has a depth of that patch in this image.
bool sees(const sensing::Camera& camera, const sensing::DepthFrame& image, const Patch& patch) {
  const Vec3 place = transform_point(glm::inverse(camera.T_world_camera), patch.place);
  const Vec3 to_camera = Vec3(camera.T_world_camera[3]) - patch.place;
  if (place.z <= 0 || glm::dot(patch.normal, glm::normalize(to_camera)) < least_cosine) return false;
  const Vec2 pixel = glm::round(sensing::project(camera, place));
  if (pixel.x < 0 || pixel.y < 0 || pixel.x >= camera.width || pixel.y >= camera.height) return false;
  const auto u = static_cast<std::uint32_t>(pixel.x), v = static_cast<std::uint32_t>(pixel.y);
  if (sensing::is_ignored(camera, u, v)) return false;
  const std::uint16_t raw = image.depth[std::size_t{v} * camera.width + u];
  return raw != 0 && raw * camera.depth_unit_m > place.z - in_front_m;
}

/// The contacts of one object, as every camera and all together see them.
void check_object(std::size_t object, const geometry::Mesh& finger, sensing::SyntheticRig& rig, RigCheck& out) {
  const std::vector<geometry::Solid> solids = load_solids(find_asset(std::string(checked_objects[object]) + ".glb"));
  const Pressed pressed = press(finger, solids);
  sensing::FrameSet seen;
  const sensing::Posed posed{&pressed.mesh, Transform(1.0), "the finger"};
  rig.render(std::span(&posed, 1), 0, seen);
  double all = 0;
  for (const Patch& patch : pressed.contacts) {
    bool by_any = false;
    for (std::size_t i = 0; i < out.cameras.size(); ++i) {
      if (!sees(rig.cameras()[i], seen.frames[i], patch)) continue;
      out.cameras[i].contacts[object] += patch.area;
      by_any = true;
    }
    out.contacts[object] += by_any ? patch.area : 0;
    all += patch.area;
  }
  for (CameraCheck& camera : out.cameras)
    camera.contacts[object] /= all;
  out.contacts[object] /= all;
}

void check_boards(const std::vector<sensing::Camera>& cameras, const geometry::Mesh& boards, RigCheck& out) {
  sensing::SyntheticRig rig(cameras, boards, sensing::Noise::d415, 1);
  sensing::FrameSet seen;
  rig.render({}, 0, seen);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::vector<std::uint16_t>& depth = seen.frames[i].depth;
    out.cameras[i].board_share = static_cast<double>(depth.size() - std::ranges::count(depth, std::uint16_t{0})) /
                                 static_cast<double>(depth.size());
  }
}

void check_target(const RigOptions& options, const PosedRig& posed, RigCheck& out) {
  StillTask task;
  task.rig = options;
  const auto source = open_still_source(task, posed, {}, pose_of_target({}, load_placed_layout(options)));
  const std::vector<sensing::StillFrames> seen = collect_still_frames(*source, frames_of_target, [](std::uint64_t) {});
  for (std::size_t i = 0; i < seen.size(); ++i) {
    try {
      out.cameras[i].hold = sensing::find_target(source->cameras()[i], seen[i].finish()).fit.hold;
    } catch (const Error& error) {
      out.cameras[i].target_fault = error.what();
    }
  }
}

}  // namespace

RigCheck check_rig(const RigOptions& options) {
  const PosedRig posed = load_posed_rig(options);
  RigCheck out;
  for (const sensing::Camera& camera : posed.rig.cameras)
    out.cameras.push_back({.name = camera.name});
  const geometry::Mesh boards = array::board_mesh(posed.layout), finger = session::load_skin(find_asset("finger.ply"));
  sensing::SyntheticRig rig(posed.rig.cameras, boards, sensing::Noise::none, 1);
  for (std::size_t object = 0; object < checked_objects.size(); ++object)
    check_object(object, finger, rig, out);
  check_boards(posed.rig.cameras, boards, out);
  check_target(options, posed, out);
  return out;
}

double least_of(const ContactShares& shares) {
  return *std::ranges::min_element(shares);
}

double mean_of(const ContactShares& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
}

}  // namespace palpa::setup
