// What many tests of sessions begin with: a scene of the assets, a finger, cameras, an array, one of both backends.
#pragma once

#include <gtest/gtest.h>

#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/rig.hpp"
#include "session/session.hpp"
#include "support/device.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

inline std::vector<geometry::Solid> asset_solids(const std::string& name) {
  return geometry::make_solids(geometry::load_gltf(source_file("assets/" + name + ".glb")));
}

/// Points on the skin of the finger model, its tip there.
inline std::vector<glm::vec3> finger_at(const Vec3& tip) {
  std::vector<glm::vec3> points;
  for (const Vec3& p : finger_skin().mesh.positions)
    points.emplace_back(p + tip);
  return points;
}

inline std::vector<sensing::Camera> paper_cameras() {
  return sensing::load_rig(source_file("assets/rigs/paper.toml")).cameras;
}

/// OpenMPD's board at its place in the world.
inline array::Layout posed_openmpd() {
  const array::Layout layout = array::load_layout("openmpd");
  return array::transformed(layout, layout.default_T_world_layout);
}

/// A test of sessions on the CPU and on the GPU.
struct OnBackends : testing::TestWithParam<bool> {
  static session::Session make(session::SessionSetting setting) {
    return GetParam() ? session::Session(test_device(), std::move(setting)) : session::Session(std::move(setting));
  }
};

inline std::string backend_name(const testing::TestParamInfo<bool>& backend) {
  return backend.param ? "gpu" : "cpu";
}

}  // namespace palpa::test
