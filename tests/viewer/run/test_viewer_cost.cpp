// What palpa-viewer costs.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "drawing/png.hpp"
#include "geometry/hostile_models.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer_here.hpp"

namespace palpa {
namespace {

using ViewerCost = test::DrawingTest;

// Thousands of objects at one place look like a hundred of them, and take no longer.
TEST_F(ViewerCost, OfManyNodesInOnePlaceIsThatOfTheirFile) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: times and memory mean nothing here";
  const auto folder = test::scratch_folder("viewer-bones");
  std::vector<std::string> shots;
  for (const int count : {130, 12'000}) {
    const auto scene = test::hostile::many_bones(count).write_glb(folder / "bones.glb");
    shots.push_back(folder / (std::to_string(count) + ".png"));
    const auto run = test::viewer({"--scene", scene, "--headless", "--size", "640x400", "--hide", "legend",
                                   "--screenshot", shots.back(), "--quiet"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    // The limit in docs/limits.md is of elapsed time, and two cores share the work.
    EXPECT_LT(run.processor_s, 2 * test::slowest * (1 + static_cast<double>(std::filesystem::file_size(scene)) / 1e6));
    EXPECT_LT(run.peak_mib, 1e9 / (1 << 20));
  }
  EXPECT_EQ(drawing::read_png(shots[0]).rgba, drawing::read_png(shots[1]).rgba);
}

}  // namespace
}  // namespace palpa
