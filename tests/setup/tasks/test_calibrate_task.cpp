// The results of `palpa calibrate`, called from C++.
#include "setup/tasks/calibrate.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "sensing/rig.hpp"
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

TEST(CalibrateTask, RefusesTooManyFramesAndIdleOptions) {
  setup::CalibrateTask task;
  task.frames = 101;
  EXPECT_ERROR(setup::calibrate(task, {}), Exit::usage, "--frames 101: at most 100");
  task.frames = 0;
  task.noise_free = true;
  task.source = "recording:x";
  EXPECT_ERROR(setup::calibrate(task, {}), Exit::usage, "--noise-free goes with");
}

}  // namespace
}  // namespace palpa::test
