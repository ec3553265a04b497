// setup/tasks/simulate.hpp: a finger's mesh from memory, and refusals.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "setup/sessions/load.hpp"
#include "setup/tasks/simulate.hpp"
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

}  // namespace
}  // namespace palpa::test
