// How deep fingers press: deep points go to the right finger.
#include <gtest/gtest.h>

#include <utility>

#include "touch/fingers/depths.hpp"

namespace palpa::touch {
namespace {

/// A finger whose contacts are the corners of a square of 10 mm around `x`, 1 mm deep.
void add_finger(Touch& touch, float x, std::uint32_t solid = 0) {
  Finger finger;
  finger.solid = solid;
  finger.section.centroid = {x, -0.001F, 0};
  for (const auto& [dx, dz] : {std::pair{-1.F, -1.F}, {1.F, -1.F}, {1.F, 1.F}, {-1.F, 1.F}}) {
    finger.contacts.push_back(static_cast<std::uint32_t>(touch.contacts.size()));
    touch.contacts.push_back({0, solid, 0.001F, {x + 0.005F * dx, -0.001F, 0.005F * dz}});
  }
  touch.fingers.push_back(finger);
  ++touch.finger_count;
}

Contact deep(float x, float depth, std::uint32_t solid = 0) {
  return {0, solid, depth, {x, -depth, 0}};
}

/// The depths of points that no camera sees.
void depths_of(Touch& touch) {
  const sensing::RayTables tables;
  find_depths({{}, tables, {}}, touch);
}

TEST(Depths, AreThoseOfTheContactsWhereNothingIsDeeper) {
  Touch touch;
  add_finger(touch, 0);
  touch.contacts[2].depth_m = 0.0014F;
  depths_of(touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.0014F);
}

TEST(Depths, DeepPointsGoToTheNearestFingerOfTheirSolid) {
  Touch touch;
  add_finger(touch, 0);
  add_finger(touch, 0.02F);
  add_finger(touch, 0.02F, 1);
  touch.deep = {deep(0.001F, 0.006F), deep(0.009F, 0.004F), deep(0.012F, 0.005F), deep(0.0F, 0.020F, 1)};
  depths_of(touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.006F);
  EXPECT_EQ(touch.fingers[1].depth_m, 0.005F) << "12 mm is nearer to the box that begins at 15 mm";
  EXPECT_EQ(touch.fingers[2].depth_m, 0.020F) << "another solid's fingers are no matter";
}

TEST(Depths, ADeepPointFarFromAllFingersIsNobodys) {
  Touch touch;
  add_finger(touch, 0);
  touch.deep = {deep(0.040F, 0.002F), deep(0, 0.032F)};
  depths_of(touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.001F);
  touch.deep = {deep(0.034F, 0.002F), deep(0, 0.030F)};
  depths_of(touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.030F);
}

TEST(Depths, FlyingPixelsDoNotPress) {
  sensing::Camera camera{.width = 20, .height = 20, .fx = 600, .fy = 600, .cx = 10, .cy = 10, .depth_unit_m = 1e-4};
  const sensing::RayTables tables = sensing::make_rays({&camera, 1});
  const std::vector<SightCamera> cameras = sight_cameras({&camera, 1}, tables);
  // Skin at 0.5 m, and a pixel that flies 15 mm behind it.
  std::vector<sensing::DepthFrame> images(1);
  images[0].depth.assign(std::size_t{20} * 20, 5000);
  const std::uint32_t flying = 7 * 20 + 7, firm = 12 * 20 + 12;
  images[0].depth[flying] = 5150;
  Touch touch;
  add_finger(touch, 0);
  for (Contact& contact : touch.contacts)
    contact.point = firm;
  Contact flies = deep(0.001F, 0.018F), presses = deep(0.001F, 0.004F);
  flies.point = flying;
  presses.point = firm;
  touch.deep = {flies, presses};
  find_depths({cameras, tables, images}, touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.004F);
  // The same for contacts.
  touch.deep.clear();
  touch.contacts[1].point = flying;
  touch.contacts[1].depth_m = 0.0014F;
  find_depths({cameras, tables, images}, touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.001F);
  depths_of(touch);
  EXPECT_EQ(touch.fingers[0].depth_m, 0.0014F) << "without cameras, all points are firm";
}

}  // namespace
}  // namespace palpa::touch
