// The results of `palpa calibrate`, called from C++.
#include "setup/tasks/calibrate.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <string>

#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "sensing/rig.hpp"
#include "setup/options/target_mount.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

/// A file of the paper's rig with a quarter of the pixels.
std::string coarse_rig() {
  sensing::Rig rig = sensing::load_rig(source_file("assets/rigs/paper.toml"));
  for (sensing::Camera& camera : rig.cameras) {
    camera.width /= 2;
    camera.height /= 2;
    for (double* length : {&camera.fx, &camera.fy})
      *length /= 2;
    for (double* centre : {&camera.cx, &camera.cy})
      *centre = (*centre - 0.5) / 2;
  }
  const std::filesystem::path file = scratch_folder("calibrate-rig") / "rig.toml";
  write_text(file, sensing::to_toml(rig));
  return file;
}

TEST(CalibrateTask, ARehearsalReportsItsFramesAndResiduals) {
  setup::CalibrateTask task;
  task.rig.rig = coarse_rig();
  task.frames = 3;
  task.seed = 3;
  task.target = {"0,0,1cm", 15};
  std::uint64_t wanted = 0, taken = 0;
  bool all = false;
  const setup::CalibrateResult result = setup::calibrate(task, {},
                                                         {.opened = [&](std::uint64_t frames) { wanted = frames; },
                                                          .taken = [&](std::uint64_t done) { taken = done; },
                                                          .all_taken = [&] { all = true; }});
  EXPECT_EQ(wanted, 3u);
  EXPECT_EQ(taken, 3u);
  EXPECT_TRUE(all);
  EXPECT_EQ(result.frames, 3u);
  ASSERT_EQ(result.rig.cameras.size(), result.cameras.size());
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    EXPECT_EQ(result.rig.cameras[i].T_world_camera, result.cameras[i].T_world_camera);
    EXPECT_EQ(result.rig.cameras[i].residual_m, result.cameras[i].found.fit.rms_m);
  }
}

TEST(TargetMount, TurnsCounterClockwiseSeenFromAbove) {
  const setup::TargetMount mount = setup::target_mount(array::load_layout("openmpd"));
  const Transform moved = setup::moved_mount(mount, {0.01, 0.02, 0.03}, std::numbers::pi / 2);
  const Vec3 x = transform_direction(moved, {1, 0, 0}), y = transform_direction(mount.T_layout_target, {0, 1, 0});
  EXPECT_LT(glm::distance(x, y), 1e-12);
  EXPECT_EQ(Vec3(moved[3]), Vec3(0.01, 0.02, 0.03));
}

}  // namespace
}  // namespace palpa::test
