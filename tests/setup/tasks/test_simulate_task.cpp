// setup/tasks/simulate.hpp: a finger's mesh from memory, and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <string>

#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/files/finger_picture.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/simulate.hpp"
#include "setup/tasks/simulate_picture.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "untimed.hpp"

namespace palpa::test {
namespace {

/// A build folder may lie outside the source tree, where palpa does not find its assets by itself.
[[maybe_unused]] const int assets_are_known = setenv("PALPA_ASSETS", source_file("assets").c_str(), 1);

std::string cube() {
  return source_file("assets/cube.glb");
}

/// A fingertip: a sphere, its lowest vertex at the origin.
geometry::Mesh tip(int divisions) {
  geometry::Mesh mesh = geometry::icosphere(5e-3, divisions);
  const Vec3 lowest = *std::ranges::min_element(mesh.positions, {}, &Vec3::y);
  for (Vec3& p : mesh.positions)
    p -= lowest;
  return mesh;
}

std::string tip_file(int divisions) {
  static const std::filesystem::path folder = scratch_folder("simulate-task");
  const std::filesystem::path file = folder / ("tip-" + std::to_string(divisions) + ".ply");
  const geometry::Mesh mesh = tip(divisions);
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

setup::SimulateTask options_of(const std::string& layout) {
  setup::SimulateTask options;
  options.compute.backend = setup::Backend::cpu;
  options.penetration_m = 1.5e-3;
  options.rig.layout = layout;
  return options;
}

setup::SimulateResult simulate(const setup::SimulateTask& options) {
  setup::check(options);
  setup::FingerBody finger(tip_file(5), setup::air(options.drive.medium, options.air));
  return setup::simulate(options, finger, cube(), setup::load_solids(cube()));
}

TEST(SimulateTask, TakesAFingerFromMemoryAndKeepsItsEquations) {
  const setup::SimulateTask options = options_of("openmpd");
  setup::FingerBody finger("a ball", geometry::load_triangles(tip_file(5)),
                           setup::air(options.drive.medium, options.air));
  const setup::SimulateResult result = setup::simulate(options, finger, cube(), setup::load_solids(cube()));
  EXPECT_EQ(untimed(to_json(result)), untimed(to_json(simulate(options))));
  EXPECT_GT(result.load.force.y, 0);
  EXPECT_NEAR(result.tip.y, -1.5e-3, 1e-12);
  EXPECT_EQ(finger.standing(result.tip.y).get(), finger.standing(result.tip.y).get());
  // If nothing is touched, it says how much is missing.
  setup::SimulateTask above = options;
  above.penetration_m = -2e-3;
  EXPECT_REFUSED(setup::simulate(above, finger, cube(), setup::load_solids(cube())),
                 "the finger touches nothing there: its skin is 2.0 mm away from the surface of cube");
  EXPECT_REFUSED(setup::simulate(options, finger, "nothing.glb", {}), "nothing.glb: has no solid to touch");
  geometry::Mesh open = tip(5);
  open.triangles.pop_back();
  EXPECT_REFUSED(setup::FingerBody("a ball", open, setup::air({}, {})), "a ball: the mesh is open");
}

TEST(SimulateTask, APenetrationIsANumber) {
  setup::SimulateTask options;
  options.penetration_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_CONTAINS(error_of([&] { setup::check(options); }, Exit::usage), "--penetration: out of range");
}

TEST(FingerFromBelow, EachSampleIsTheLowestSkinAtItsPlace) {
  const geometry::Mesh ball = tip(20);
  const Vec3 at(2e-3, 7e-3, -1e-3), centre(0, 5e-3, 0);
  const setup::SeenFromBelow seen(ball, at);
  for (std::size_t i = 0; i < seen.y.size(); ++i) {
    // x to the right, z upwards.
    const double x = at.x - setup::below_half_m +
                     (static_cast<double>(i % setup::below_side) + 0.5) * setup::below_step_m,
                 z = at.z + setup::below_half_m -
                     (static_cast<double>(i / setup::below_side) + 0.5) * setup::below_step_m;
    const double beside = std::hypot(x, z);
    if (beside > 5e-3) {
      ASSERT_EQ(seen.face[i], -1) << i;
    }
    if (beside > 4.5e-3) continue;
    ASSERT_GE(seen.face[i], 0) << i;
    const glm::uvec3& face = ball.triangles[static_cast<std::size_t>(seen.face[i])];
    const Vec3 skin(x, centre.y - std::sqrt(25e-6 - beside * beside), z);
    ASSERT_NEAR(seen.y[i], skin.y, 0.05e-3) << i;
    ASSERT_LT(glm::distance((ball.positions[face.x] + ball.positions[face.y] + ball.positions[face.z]) / 3.0, skin),
              0.5e-3)
        << i;
  }
}

TEST(FingerFromBelow, FociAreMarkedAtTheirPlaces) {
  setup::SimulateResult result;
  result.body = tip(4);
  result.tip = Vec3(1e-3, 2e-3, -3e-3);
  for (Vec3& p : result.body.positions)
    p += result.tip;
  const drawing::Pixels plain = setup::foci_picture(result, 8e-3, "");
  // The middle of what differs from the picture without a focus.
  const auto mark = [&](const Vec3& from_tip) {
    result.foci = {result.tip + from_tip, std::nullopt};
    const drawing::Pixels marked = setup::foci_picture(result, 8e-3, "");
    Vec2 low(1e9), high(-1e9);
    for (std::uint32_t y = 0; y < plain.height; ++y) {
      if (std::memcmp(plain.at(0, y), marked.at(0, y), std::size_t{4} * plain.width) == 0) continue;
      for (std::uint32_t x = 0; x < plain.width; ++x) {
        if (std::equal(plain.at(x, y), plain.at(x, y) + 4, marked.at(x, y))) continue;
        low = glm::min(low, Vec2(x, y));
        high = glm::max(high, Vec2(x, y));
      }
    }
    return (low + high) / 2.0;
  };
  const Vec2 right = mark(Vec3(2e-3, 1e-3, 0)), up = mark(Vec3(0, -1e-3, 3e-3));
  EXPECT_GT(right.x, up.x + 10);
  EXPECT_GT(right.y, up.y + 10);
  EXPECT_NEAR((right.x - up.x) / (right.y - up.y), 2.0 / 3, 0.05);
}

}  // namespace
}  // namespace palpa::test
