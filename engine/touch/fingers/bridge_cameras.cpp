#include "touch/fingers/bridge_cameras.hpp"

#include <glm/matrix.hpp>

namespace palpa::touch {
namespace {

shader::vec4 row_of(const Transform& T, int row) {
  return {static_cast<float>(T[0][row]), static_cast<float>(T[1][row]), static_cast<float>(T[2][row]),
          static_cast<float>(T[3][row])};
}

}  // namespace

std::vector<BridgeCamera> bridge_cameras(std::span<const sensing::Camera> cameras, const sensing::RayTables& tables) {
  std::vector<BridgeCamera> out;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const sensing::Camera& camera = cameras[i];
    const sensing::CameraTable& table = tables.cameras[i];
    const Transform& pose = camera.T_world_camera;
    const Transform view = glm::inverse(pose);
    const auto single = [](double value) { return static_cast<float>(value); };
    const auto& [k1, k2, p1, p2, k3] = camera.distortion;
    out.push_back({.pose_x = row_of(pose, 0),
                   .pose_y = row_of(pose, 1),
                   .pose_z = row_of(pose, 2),
                   .view_x = row_of(view, 0),
                   .view_y = row_of(view, 1),
                   .view_z = row_of(view, 2),
                   .lens = {single(camera.fx), single(camera.fy), single(camera.cx), single(camera.cy)},
                   .distortion = {single(k1), single(k2), single(p1), single(p2)},
                   .k3 = single(k3),
                   .reach = table.reach * 1.01F,  // a little more for rounding
                   .depth_unit = single(camera.depth_unit_m),
                   .first_depth = sensing::first_valid_depth(camera),
                   .width = table.width,
                   .height = table.height,
                   .pitch = table.pitch,
                   .first_pixel = static_cast<std::uint32_t>(table.first_pixel),
                   .first_index = static_cast<std::uint32_t>(table.first_index)});
  }
  return out;
}

}  // namespace palpa::touch
