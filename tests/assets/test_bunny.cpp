// The demo's bunny, without the bunny: the downloaded file is a script with two arrays.
#include <gtest/gtest.h>

#include <fstream>
#include <glm/geometric.hpp>

#include "assets/generators/bunny.hpp"
#include "assets/generators/finger.hpp"
#include "assets/generators/objects.hpp"
#include "base/error.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::assets {
namespace {

geometry::Mesh read(const std::string& script) {
  static const auto folder = test::scratch_folder("bunny");
  std::ofstream(folder / "index.js") << script;
  return read_bunny(folder / "index.js");
}

TEST(Bunny, TwoArraysOfAScript) {
  const geometry::Mesh mesh = read(
      "exports.positions=[[0,0,0],[1.5,0,0],[0,-2e-1,0],\n [0, 0, "
      "1]]\nexports.cells=[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]\n");
  ASSERT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.positions[2], Vec3(0, -0.2, 0));
  ASSERT_EQ(mesh.triangles.size(), 4U);
  EXPECT_EQ(mesh.triangles[3], glm::uvec3(0, 3, 2));
}

TEST(Bunny, AnythingElseIsRefused) {
  for (const char* script :
       {"cells=[[0,0,0]]", "positions=[[0,0]];cells=[[0,0,0]]", "positions=[[0,0,0],;cells=[[0,0,0]]",
        "positions=[[0,0,0]", "positions=f();cells=[[0,0,0]]", " "}) {
    EXPECT_REFUSED(read(script), "array positions=") << script;
  }
  EXPECT_REFUSED(read("exports.positions=[[0,0,0]]"), "array cells=");
  for (const char* script : {"positions=[[0,0,0]];cells=[[0,0,1]]", "positions=[[0,0,0]];cells=[[0,0,-1]]",
                             "positions=[[0,0,0]];cells=[[0,0,0.5]]"}) {
    EXPECT_REFUSED(read(script), "names no position") << script;
  }
}

TEST(Bunny, StandsOnTheGround) {
  const Box box = geometry::bounds(stand_up(make_cube(), 0.1));
  EXPECT_NEAR(glm::length(box.low - Vec3(-0.05, 0, -0.05)), 0, 1e-12);
  EXPECT_NEAR(glm::length(box.high - Vec3(0.05, 0.1, 0.05)), 0, 1e-12);
}

TEST(Bunny, FingersArePressedInTheirDirection) {
  const geometry::Mesh finger = make_finger(), cube = stand_up(make_cube(), 0.1);
  for (const Vec3& way : {Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, -2)}) {
    const geometry::Mesh pressed = press_finger(finger, cube, Vec3(0, 0.05, 0), way, 0.003);
    const Vec3 inwards = glm::normalize(way);
    // The tip moves farthest.
    double farthest = -1;
    for (const Vec3& p : pressed.positions)
      farthest = std::max(farthest, glm::dot(p - Vec3(0, 0.05, 0), inwards));
    EXPECT_NEAR(farthest, -0.05 + 0.003, 1e-9);
    EXPECT_NEAR(geometry::signed_volume(pressed), geometry::signed_volume(finger), 1e-12);
  }
  EXPECT_ERROR(press_finger(finger, cube, Vec3(0, 0.5, 0), Vec3(1, 0, 0), 0.003), Exit::failed, "misses the object");
}

}  // namespace
}  // namespace palpa::assets
