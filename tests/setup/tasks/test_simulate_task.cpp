// setup/tasks/simulate.hpp and figure6.hpp: the same bytes as `palpa simulate`, and a finger's mesh from memory.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "drawing/png.hpp"
#include "geometry/files/load_triangles.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "same_json.hpp"
#include "setup/load.hpp"
#include "setup/tasks/figure6.hpp"
#include "setup/tasks/simulate.hpp"
#include "setup/tasks/simulate_picture.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

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

std::vector<std::string> command(const std::vector<std::string>& more) {
  return with({"simulate", "--scene", cube(), "--finger", tip_file(5), "--penetration", "1.5mm", "--layout", "openmpd",
               "--backend", "cpu"},
              more);
}

setup::SimulateResult simulate(const setup::SimulateTask& options) {
  setup::check(options);
  setup::FingerBody finger(tip_file(5), setup::air(options.drive.medium, options.air));
  return setup::simulate(options, finger, cube(), setup::load_solids(cube()));
}

TEST(SimulateTask, HasTheCommandsBytes) {
  setup::SimulateTask options = options_of("openmpd");
  expect_same_json(to_json(simulate(options)), command({}));
  options.in_time.spectrum = options.touch.tune = true;
  options.drive.transfer = setup::TransferChoice::finger;
  expect_same_json(to_json(simulate(options)), command({"--spectrum", "--tune", "--transfer", "finger"}));
  options = options_of("openmpd");
  options.spread = {.text = "phase=0.2,temperature=1", .draws = 20};
  options.compute.seed = 3;
  expect_same_json(to_json(simulate(options)),
                   command({"--spread", "phase=0.2,temperature=1", "--draws", "20", "--seed", "3"}));
  options = options_of("openmpd");
  options.skin = setup::Skin::cameras;
  options.compute.seed = 7;
  options.touch.method.method = touch::Method::single_focus;
  expect_same_json(to_json(simulate(options)),
                   command({"--skin", "cameras", "--seed", "7", "--method", "single-focus"}));
}

TEST(SimulateTask, ItsTableModelAndPicturesAreTheCommands) {
  const std::filesystem::path folder = scratch_folder("simulate-task");
  const std::filesystem::path csv = folder / "a.csv", vtu = folder / "a.vtu", png = folder / "a.png";
  ASSERT_EQ(palpa(command({"--csv", csv, "--vtu", vtu, "--png", png})).exit_code, 0);
  const setup::SimulateResult result = simulate(options_of("openmpd"));
  EXPECT_EQ(to_csv(result), read_text(csv));
  write_vtu(folder / "b.vtu", result);
  EXPECT_EQ(read_text(folder / "b.vtu"), read_text(vtu));
  const drawing::Pixels both = drawing::read_png(png), foci = foci_picture(result, result.top_m, "Foci");
  ASSERT_GT(both.width, foci.width);
  for (std::uint32_t y = 0; y < foci.height; ++y)
    EXPECT_TRUE(std::equal(foci.at(0, y), foci.at(0, y) + std::size_t{4} * foci.width, both.at(0, y))) << y;
}

TEST(SimulateTask, TakesAFingerFromMemoryAndKeepsItsEquations) {
  const setup::SimulateTask options = options_of("openmpd");
  setup::FingerBody finger("a ball", geometry::load_triangles(tip_file(5)),
                           setup::air(options.drive.medium, options.air));
  const setup::SimulateResult result = setup::simulate(options, finger, cube(), setup::load_solids(cube()));
  EXPECT_EQ(without_times(to_json(result)), without_times(to_json(simulate(options))));
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

TEST(SimulateTask, ChecksWhatDoesNotGoTogether) {
  setup::SimulateTask options;
  options.noise_free = true;
  EXPECT_CONTAINS(error_of([&] { setup::check(options); }, Exit::usage), "--skin cameras");
  options.skin = setup::Skin::cameras;
  setup::check(options);
  options.penetration_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_CONTAINS(error_of([&] { setup::check(options); }, Exit::usage), "--penetration: out of range");
  options.penetration_m = 3e-3;
  options.touch.spot_m = 4e-3;
  EXPECT_CONTAINS(error_of([&] { setup::check(options); }, Exit::usage), "--spot goes with");
}

TEST(SimulateTask, TheFigureHasTheCommandsBytes) {
  setup::SimulateTask options = options_of("openmpd");
  setup::FingerBody finger(tip_file(5), setup::air({}, {}));
  options.penetration_m = 3e-3;
  const std::vector<setup::Figure6Touch> touches = setup::figure6(options, finger);
  ASSERT_EQ(touches.size(), 20u);
  EXPECT_TRUE(touches[0].result.bare_elongation);
  expect_same_json(setup::to_json(touches), {"simulate", "--figure6", "--finger", tip_file(5), "--penetration", "3mm",
                                             "--layout", "openmpd", "--backend", "cpu"});
}

}  // namespace
}  // namespace palpa::test
