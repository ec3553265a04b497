// What the cameras of a rig would see, and that palpa's own rigs for one board see enough.
#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <string>

#include "array/layouts/board_types.hpp"
#include "sensing/find_target.hpp"
#include "sensing/rig.hpp"
#include "setup/tasks/rig_check.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

std::string own_rig(const std::string& name) {
  return source_file("assets/rigs/" + name + ".toml").string();
}

setup::RigCheck check_of(const std::string& file) {
  setup::RigOptions options;
  options.rig = file;
  return setup::check_rig(options);
}

setup::RigCheck check_of(const sensing::Rig& rig) {
  const std::string file = scratch_folder("rig-check") / "rig.toml";
  write_text(file, sensing::to_toml(rig));
  return check_of(file);
}

TEST(RigCheck, OneCameraBesideABoardSeesTheTargetAndTheFrontOfAFingertip) {
  for (const array::BoardType& board : array::board_types()) {
    SCOPED_TRACE(board.name);
    const setup::RigCheck check = check_of(own_rig(std::string(board.name) + "-one"));
    ASSERT_EQ(check.cameras.size(), 1u);
    EXPECT_EQ(check.contacts, check.cameras[0].contacts) << "alone, it is all";
    EXPECT_EQ(check.cameras[0].target_fault, "");
    EXPECT_GT(check.cameras[0].hold, 0.2) << "palpa calibrate needs half of that";
    EXPECT_LT(check.cameras[0].board_share, 0.06);
    // Contacts of a sphere lie in a ring whose normals point about 45 degrees down. 47 % of them face a camera 10
    // degrees below by a cosine of 0.2 or more: acos((0.2 - sin 45 sin 10) / (cos 45 cos 10)) / 180 degrees.
    EXPECT_NEAR(check.contacts[0], 0.47, 0.03) << "cube";
    for (const double share : check.contacts) {
      EXPECT_GT(share, 0.38);
      EXPECT_LT(share, 0.5);
    }
  }
}

TEST(RigCheck, TwoCamerasSeeNearlyAllAround) {
  const setup::RigCheck check = check_of(own_rig("openmpd-two"));
  ASSERT_EQ(check.cameras.size(), 2u);
  for (const setup::CameraCheck& camera : check.cameras)
    EXPECT_GT(camera.hold, 0.2) << camera.name << camera.target_fault;
  EXPECT_GT(setup::least_of(check.contacts), 0.75);
  EXPECT_NEAR(check.contacts[0], check.cameras[0].contacts[0] + check.cameras[1].contacts[0], 0.03)
      << "they stand opposite each other";
}

TEST(RigCheck, WhatSeveralCamerasSeeCountsForEachOfThem) {
  sensing::Rig rig = sensing::load_rig(own_rig("openmpd-two"));
  rig.cameras[1].T_world_camera = rig.cameras[0].T_world_camera;
  const setup::RigCheck check = check_of(rig);
  EXPECT_GT(check.contacts[0], 0.4);
  for (const setup::CameraCheck& camera : check.cameras)
    EXPECT_EQ(camera.contacts, check.contacts) << camera.name << " stands where the other one stands";
}

TEST(RigCheck, TheRigsOfAllBoardsStandAlikeAndFarEnoughAway) {
  for (const char* cameras : {"-one", "-two"}) {
    const sensing::Rig usual = sensing::load_rig(own_rig(std::string("openmpd") + cameras));
    for (const array::BoardType& board : array::board_types()) {
      const sensing::Rig rig = sensing::load_rig(own_rig(std::string(board.name) + cameras));
      EXPECT_EQ(rig.array->layout, board.name);
      ASSERT_EQ(rig.cameras.size(), usual.cameras.size());
      for (std::size_t i = 0; i < rig.cameras.size(); ++i)
        EXPECT_EQ(rig.cameras[i].T_world_camera, usual.cameras[i].T_world_camera);
    }
    for (const sensing::Camera& camera : usual.cameras) {
      const Vec3 place(camera.T_world_camera[3]), front(camera.T_world_camera[2]);
      EXPECT_NEAR(glm::length(place), 0.403, 0.001);
      for (const double x : {-0.065, 0.065}) {
        for (const double z : {-0.065, 0.065})
          EXPECT_GT(glm::dot(Vec3(x, -0.184, z) - place, front), 0.28) << "a corner of the target's plate";
      }
    }
  }
}

TEST(RigCheck, ACameraSoLowThatTheBoardLooksLikeThePlateIsNotWell) {
  sensing::Rig rig = sensing::load_rig(own_rig("openmpd-one"));
  for (const double y : {-0.095, -0.1}) {
    rig.cameras[0].T_world_camera[3].y = y;
    const setup::CameraCheck low = check_of(rig).cameras[0];
    EXPECT_EQ(low.hold, 0) << y;
    EXPECT_CONTAINS(low.target_fault, "the plate and two slopes");
  }
}

TEST(RigCheck, WhatACameraCannotSeeCountsAsNotSeen) {
  sensing::Rig rig = sensing::load_rig(own_rig("openmpd-two"));
  sensing::Camera &masked = rig.cameras[0], &away = rig.cameras[1];
  masked.roi = sensing::PixelBox{0, 0, 10, 10};
  away.T_world_camera = glm::rotate(away.T_world_camera, 3.0, Vec3(0, 1, 0));
  const setup::RigCheck check = check_of(rig);
  EXPECT_EQ(check.contacts, setup::ContactShares{});
  EXPECT_GT(check.cameras[0].hold, 0.2) << "its roi does not matter to the target";
  EXPECT_EQ(check.cameras[1].hold, 0);
  EXPECT_CONTAINS(check.cameras[1].target_fault, "camera \"back right\"");
  EXPECT_EQ(check.cameras[1].board_share, 0);
}

}  // namespace
}  // namespace palpa::test
