// Compares whole pictures with those in references/, for changes that a person would see. After an intended change,
//   PALPA_DRAW_REFERENCES=1 build/release/bin/tests_viewer --gtest_filter='References.*'
// draws them again; look at them before you commit them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "drawing_test.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/shared_data.hpp"
#include "viewer/run/viewer_here.hpp"

namespace palpa {
namespace {

using References = test::DrawingTest;
using test::source_file;

/// Mean difference of a channel: drivers and vector widths differ by a tenth of this, a missing outline by more.
constexpr const char* threshold = "0.0006";

// The program draws the same bytes as this process: test_program.cpp.
TEST_F(References, EveryPictureIsAsEver) {
  const std::string finger = source_file("assets/finger.ply").string();
  // A small ball is quick to compute.
  const std::string ball = (test::scratch_folder("reference-afferents") / "ball.ply").string();
  const geometry::Mesh mesh = geometry::icosphere(6e-3, 8);
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  struct Case {
    std::string name, asset, skin;
    std::vector<std::string> more;
  };
  for (const Case& one : std::vector<Case>{
           {"touch", "semi-sphere.glb", finger, {"--slot", "2"}},
           {"array", "pyramid.glb", finger, {"--layout", "openmpd", "--amplitude", "distance", "--dark"}},
           {"section", "cube.glb", finger, {"--frame", "touch", "--show", "sections"}},
           {"afferents", "cube.glb", ball, {"--layout", "autd3", "--heat", "PC", "--eye", "-0.02,-0.05,0.05"}},
       }) {
    SCOPED_TRACE(one.name);
    const std::vector<std::string> line =
        test::with({"--scene", source_file("assets/" + one.asset).string(), "--points", one.skin, "--skin", one.skin,
                    "--penetration", "3mm", "--headless", "--size", "480x300"},
                   one.more);
    const std::string file = (source_file("tests/viewer/references") / (one.name + ".png")).string();
    if (std::getenv("PALPA_DRAW_REFERENCES") != nullptr) {
      EXPECT_EQ(test::viewer_here(test::with(line, {"--screenshot", file})).exit_code, 0);
      continue;
    }
    const std::vector<std::string> compared = test::with(line, {"--reference", file, "--threshold", threshold});
    const auto run = test::viewer_here(compared);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    const auto other = test::viewer_here(test::with(compared, {"--backend", "cpu", "--hide", "edges"}));
    EXPECT_EQ(other.exit_code, 1) << "without a line there is a difference";
  }
}

}  // namespace
}  // namespace palpa
