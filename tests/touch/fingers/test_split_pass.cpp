// SplitPass by itself, between guard words: many cameras, and as many split clusters as there can be fingers.
#include <gtest/gtest.h>

#include <cmath>

#include "touch/fingers/finger_scenes.hpp"
#include "touch/fingers/guarded_fingers.hpp"
#include "touch/split/split_pass.hpp"
#include "touch/split/split_twin.hpp"

namespace palpa::touch::test {
namespace {

/// The pass between guard words gives what the twin gives.
void expect_as_the_twin(const FingerScene& scene, Touch& twin) {
  gpu::Device& device = palpa::test::test_device();
  const SplitPass pass(device);
  const auto tables = sensing::make_rays(scene.cameras);
  Parameters unsplit = scene.parameters;
  unsplit.finger_width_m = 0;
  HostStage({scene.solid}, scene.cameras, {.parameters = unsplit}).touch(scene.images, twin);
  GuardedFingers guarded(device, scene.cameras, tables, scene.images, twin, SplitPass::scratch(), split_clusters);
  const auto count = static_cast<std::uint32_t>(twin.contacts.size());
  palpa::test::run_on_device([&](VkCommandBuffer commands) {
    pass.record(commands, guarded.bindings<SplitBindings>(), guarded.scratch, {.points = count, .contacts = count},
                scene.parameters, {});
  });
  EXPECT_TRUE(guarded.intact());

  split_fingers({bridge_cameras(scene.cameras, tables), tables, scene.images}, scene.parameters, {}, twin);
  const auto header = guarded.header.read<shader::TouchHeader>()[0];
  EXPECT_EQ(header.clusters, twin.cluster_count);
  ASSERT_EQ(header.fingers, twin.finger_count);
  const auto list = guarded.fingers.read<shader::FingerRecord>();
  const auto roots = guarded.parents.read<std::uint32_t>();
  for (std::uint32_t f = 0; f < twin.finger_count; ++f) {
    ASSERT_EQ(list[f].first, twin.fingers[f].contacts.front());
    EXPECT_EQ(list[f].contacts, twin.fingers[f].contacts.size());
    for (const std::uint32_t i : twin.fingers[f].contacts)
      ASSERT_EQ(roots[i], roots[list[f].first]);
  }
}

TEST(SplitPassByItself, StaysInsideItsBuffersWithEightCameras) {
  std::mt19937 random(23);
  const FingerScene scene = random_scene(random, SceneKind::pair_deep, 8);
  Touch twin;
  expect_as_the_twin(scene, twin);
  EXPECT_EQ(twin.finger_count, 2u);
}

/// 8 x 8 places, in each three ridges of skin side by side, 18 mm from each other and 14 mm wide, before one camera.
FingerScene ridges() {
  FingerScene scene;
  scene.solid = box({-0.4, -0.05, -0.3}, {0.4, 0, 0.3}, "plate");
  sensing::Camera camera;
  camera.width = 848;
  camera.height = 480;
  camera.fx = camera.fy = 640;
  camera.cx = 423.5;
  camera.cy = 239.5;
  camera.depth_unit_m = 1e-4;
  constexpr double away_m = 0.6, pitch_x = 70e-3, pitch_z = 40e-3;
  camera.T_world_camera = Transform(Vec4(1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0, -1, 0, 0), Vec4(0, away_m, 0, 1));
  sensing::DepthFrame picture;
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      const double x = (u - camera.cx) / camera.fx * away_m + 4 * pitch_x;
      const double z = (v - camera.cy) / camera.fy * away_m + 4 * pitch_z;
      const bool inside = x > 0 && x < 8 * pitch_x && z > 0 && z < 8 * pitch_z;
      const double across = std::remainder(std::fmod(x, pitch_x) - pitch_x / 2, 18e-3);
      const bool ridge = inside && std::abs(std::fmod(x, pitch_x) - pitch_x / 2) < 26e-3 &&
                         std::abs(std::fmod(z, pitch_z) - pitch_z / 2) < 8e-3;
      // Seen from above its hollows are deep, and its crests just below the plate's top.
      const double below = std::abs(across) < 7e-3 ? 0.3e-3 + 1.1e-3 * (across / 7e-3) * (across / 7e-3) : 8e-3;
      picture.depth.push_back(ridge ? static_cast<std::uint16_t>((away_m + below) / camera.depth_unit_m) : 0);
    }
  }
  scene.cameras = {camera};
  scene.images = {picture};
  return scene;
}

TEST(SplitPassByItself, CutsAsManyClustersAsThereAre) {
  const FingerScene scene = ridges();
  Touch twin;
  expect_as_the_twin(scene, twin);
  EXPECT_GE(twin.cluster_count, 2u * 64u);
  EXPECT_EQ(twin.finger_count, 64u);
}

}  // namespace
}  // namespace palpa::touch::test
