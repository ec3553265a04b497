// Ctrl-C while `palpa field`, `scatter` or `simulate` computes for long.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

TEST(LongWork, SaysWhatItDoesAndEndsAtOnceOnCtrlCWithoutAFile) {
  PALPA_TERMINAL_OR_SKIP();
  const std::filesystem::path folder = scratch_folder("ctrl-c"), out = folder / "out";
  std::filesystem::create_directories(out);
  // A large finger, its tip at the origin.
  geometry::Mesh mesh = geometry::icosphere(15e-3, 22);
  const Vec3 lowest = *std::ranges::min_element(mesh.positions, {}, &Vec3::y);
  for (Vec3& p : mesh.positions)
    p -= lowest;
  const std::string finger = folder / "finger.ply", sum = "summing the sound of transducers",
                    matrix = "filling the matrix of the surface";
  geometry::write_ply(finger, mesh.positions, mesh.triangles);
  const std::vector<std::string> drawn{"--vtu", out / "a.vtu", "--png", out / "a.png"};
  const std::vector<std::string> field = with(drawn, {"--layout", "paper", "--focus", "0,0,0", "--plane", "xy",
                                                      "--size", "60mm,60mm", "--pixels", "1500,1500"});
  const std::pair<std::vector<std::string>, std::string> lines[]{
      {with({"field", "--backend", "gpu"}, field), sum},
      {with({"field", "--backend", "cpu"}, field), sum},
      {{"scatter", "--mesh", finger, "--plane-wave", "0,0,1"}, matrix},
      {with({"simulate", "--scene", source_file("assets/cube.glb"), "--finger", finger, "--backend", "cpu"}, drawn),
       matrix}};
  for (const auto& [line, told] : lines) {
    SCOPED_TRACE(testing::PrintToString(line));
    Terminal terminal(with(line, {"--csv", out / "a.csv", "--json", out / "a.json"}));
    EXPECT_TRUE(terminal.shows(told)) << terminal.text();
    terminal.type("\x03");
    EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
    EXPECT_LT(terminal.processor_s_to_end(), slowest);
    EXPECT_TRUE(std::filesystem::is_empty(out));
  }
}

}  // namespace
}  // namespace palpa::test
