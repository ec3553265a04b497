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

std::string finger() {
  return source_file("assets/finger.ply").string();
}

std::vector<std::string> line_of(const std::string& asset, const std::vector<std::string>& more,
                                 const std::string& skin) {
  const std::vector<std::string> arguments{"--scene",       source_file("assets/" + asset).string(),
                                           "--points",      skin,
                                           "--skin",        skin,
                                           "--penetration", "3mm",
                                           "--headless",    "--size",
                                           "480x300"};
  return test::with(arguments, more);
}

// The program draws the same bytes as this process: test_program.cpp.
test::Result draw(const std::string& asset, const std::vector<std::string>& more, const std::string& skin) {
  return test::viewer_here(line_of(asset, more, skin));
}

void expect_as_ever(const std::string& name, const std::string& asset, const std::vector<std::string>& more,
                    const std::string& skin = finger()) {
  const std::string file = source_file("tests/viewer/references").string() + "/" + name + ".png";
  if (std::getenv("PALPA_DRAW_REFERENCES") != nullptr) {
    const auto run = draw(asset, test::with(more, {"--screenshot", file}), skin);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return;
  }
  const std::vector<std::string> compared = test::with(more, {"--reference", file, "--threshold", threshold});
  const auto run = draw(asset, compared, skin);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto other =
      test::viewer_here(line_of(asset, test::with(compared, {"--backend", "cpu", "--hide", "edges"}), skin));
  EXPECT_EQ(other.exit_code, 1) << "without a line there is a difference";
}

TEST_F(References, Touch) {
  expect_as_ever("touch", "semi-sphere.glb", {"--slot", "2"});
}

TEST_F(References, Array) {
  expect_as_ever("array", "pyramid.glb", {"--layout", "openmpd", "--dark"});
}

TEST_F(References, Section) {
  expect_as_ever("section", "cube.glb", {"--frame", "touch", "--show", "sections"});
}

/// A small ball is quick to compute.
TEST_F(References, Afferents) {
  const std::string ball = (test::scratch_folder("reference-afferents") / "ball.ply").string();
  const geometry::Mesh mesh = geometry::icosphere(6e-3, 8);
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  expect_as_ever("afferents", "cube.glb", {"--layout", "autd3", "--heat", "PC", "--eye", "-0.02,-0.05,0.05"}, ball);
}

}  // namespace
}  // namespace palpa
