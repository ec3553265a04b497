// setup/tasks/touch.hpp: skin from memory, and refusals.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "geometry/files/ply.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/touch.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "untimed.hpp"

namespace palpa::test {
namespace {

std::string cube() {
  return source_file("assets/cube.glb");
}
std::string finger() {
  return source_file("assets/finger.ply");
}

setup::TouchResult touch(const setup::TouchTask& options, double penetration_m) {
  setup::check(options, false);
  std::vector<geometry::Solid> solids = setup::load_solids(cube());
  setup::TouchInputOptions input;
  input.points = finger();
  input.penetration_m = penetration_m;
  const setup::TouchInput skin = setup::load_touch_input(input, solids);
  return setup::touch_scene(options, cube(), std::move(solids), skin);
}

TEST(TouchTask, TakesSkinFromMemory) {
  // The finger as --penetration 3mm places it below the cube's top, y = 0.
  std::vector<geometry::Solid> solids = setup::load_solids(cube());
  std::vector<Vec3> points = geometry::read_ply(finger()).positions;
  const double dy = setup::lowering(solids, points, 3e-3);
  for (Vec3& point : points)
    point.y += dy;
  setup::TouchTask options;
  options.compute.backend = setup::Backend::cpu;
  const setup::TouchResult result =
      setup::touch_scene(options, cube(), std::move(solids), setup::skin_points("skin", points));
  EXPECT_EQ(result.values.points, points.size());
  EXPECT_EQ(result.touch().finger_count, 1u);
  EXPECT_EQ(untimed(to_json(result.values)), untimed(to_json(touch(options, 3e-3).values)));
  points[5].x = 1e39;
  EXPECT_REFUSED(setup::skin_points("skin", points), "skin: vertex 5");
}

TEST(TouchTask, NothingTouchedIsNoError) {
  setup::TouchTask options;
  options.compute.backend = setup::Backend::cpu;
  options.array.layout = "openmpd";
  const setup::TouchResult result = touch(options, -1e-3);
  EXPECT_TRUE(result.touch().contacts.empty());
  EXPECT_TRUE(result.values.pressures.empty());
  EXPECT_FALSE(result.unreached);
}

TEST(TouchTask, ChecksTheRangesThatTheCommandLineHas) {
  const auto refused = [](const auto& change, const char* option) {
    setup::TouchTask options;
    options.touch.tune = true;
    options.felt.spectrum = true;
    change(options);
    EXPECT_CONTAINS(error_of([&] { setup::check(options, false); }, Exit::usage), std::string(option) + ": '");
  };
  for (const double wrong : {-1.0, 1e9, std::nan(""), std::numeric_limits<double>::infinity()}) {
    refused([&](setup::TouchTask& options) { options.touch.dwell_s = wrong; }, "--dwell");
    refused([&](setup::TouchTask& options) { options.touch.modulation_hz = wrong; }, "--modulation-frequency");
    refused([&](setup::TouchTask& options) { options.touch.spot_m = wrong; }, "--spot");
    refused([&](setup::TouchTask& options) { options.felt = {false, wrong, 5e-3}; }, "--tune-shortest");
    refused([&](setup::TouchTask& options) { options.felt = {false, 1e-3, wrong}; }, "--tune-longest");
  }
  setup::TouchTask options;
  EXPECT_NO_THROW(setup::check(options, false));
}

}  // namespace
}  // namespace palpa::test
