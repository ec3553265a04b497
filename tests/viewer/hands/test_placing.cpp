// Moving solids and the finger by hand.
#include "viewer/hands/placing.hpp"

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>

namespace palpa::viewer {
namespace {

SurfaceMark box(const char* name, double x, std::uint32_t solid) {
  SurfaceMark mark{.name = name, .solid = solid};
  mark.mesh.positions = {{x - 0.01, -0.02, -0.01}, {x + 0.01, 0, 0.01}};
  return mark;
}

using Kind = WindowEvent::Kind;

class PlacingTest : public testing::Test {
 protected:
  PlacingTest() {
    rest.solids = {box("left", -0.03, 0), box("right", 0.03, 1)};
    rest.tile = {glm::vec3(0.025f, 0, 0.005f), glm::vec3(0.035f, 0, 0.005f), glm::vec3(0.035f, 0, -0.005f),
                 glm::vec3(0.025f, 0, -0.005f)};
    rest.tile_solid = 1;
    sight.viewpoint.azimuth = sight.viewpoint.elevation = 0;  // x to the right, y up
    placing.begin(rest, true, false);
  }
  bool send(const WindowEvent& event) { return placing.handle(event, sight); }
  bool does(Kind kind, const Vec2& at = {}, Button button = Button::left) {
    return send({.kind = kind, .x = at.x, .y = at.y, .button = button});
  }
  bool key(Key key, bool ctrl = false) { return send({.kind = Kind::key, .ctrl = ctrl, .key = key}); }
  bool key(char letter, bool ctrl = false) { return key(key_of(letter), ctrl); }
  bool scroll(double steps, bool shift = false, bool ctrl = false) {
    return send({.kind = Kind::scroll, .steps = steps, .shift = shift, .ctrl = ctrl});
  }
  Vec2 pixel(const Vec3& p) const {
    const Projected at = project(projection(sight.viewpoint, sight.width, sight.height), p);
    return {at.x, at.y};
  }
  Vec3 tip() const { return Vec3(placing.finger()[3]); }
  /// Drags along +x by its arrow, for 30 pixels.
  void drag(const Vec3& middle) {
    const Gizmo gizmo = gizmo_at(middle, sight);
    const Vec2 from = pixel(middle + Vec3(0.9 * gizmo.size_m, 0, 0));
    EXPECT_TRUE(does(Kind::press, from));
    EXPECT_TRUE(does(Kind::move, from + Vec2(30, 4)));
  }

  Picture rest;
  Sight sight{.viewpoint = {}, .width = 800, .height = 600, .ratio = 1};
  Placing placing;
};

TEST_F(PlacingTest, AFingerWaitsAboveTheHighestSolidAndThenItsTipIsUnderThePointer) {
  EXPECT_LT(glm::distance(tip(), Vec3(0.03, 0.004, 0)), 1e-7);
  const double depth = tip().z;
  for (const Vec2& at : {Vec2(300, 200), Vec2(500, 450)}) {
    EXPECT_FALSE(does(Kind::move, at)) << "others may use the pointer, too";
    EXPECT_LT(glm::distance(pixel(tip()), at), 1e-2);
    EXPECT_NEAR(tip().z, depth, 1e-9) << "in the plane that faces the viewer";
  }
  EXPECT_TRUE(scroll(2));
  EXPECT_NEAR(tip().z, depth - 2e-3, 1e-12) << "away from the viewer";
  EXPECT_TRUE(scroll(-1, true));
  EXPECT_NEAR(tip().z, depth - 1.9e-3, 1e-12);
  EXPECT_FALSE(scroll(1, false, true)) << "with Ctrl the wheel is the view's";
}

TEST_F(PlacingTest, TheFingerStaysWhileTheViewIsTurnedAndWhereItIsToldTo) {
  does(Kind::move, {400, 300});
  const Vec3 before = tip();
  EXPECT_FALSE(does(Kind::press, {400, 300}));
  does(Kind::move, {500, 300});
  EXPECT_EQ(tip(), before);
  does(Kind::release, {500, 300});
  does(Kind::move, {500, 300});
  const Vec3 there = tip();
  EXPECT_NE(there, before);
  EXPECT_TRUE(key('m'));
  does(Kind::move, {300, 200});
  EXPECT_FALSE(scroll(1));
  EXPECT_EQ(tip(), there);
}

TEST_F(PlacingTest, ARightDragTurnsTheFingerAroundItsTip) {
  const Transform before = placing.finger();
  EXPECT_TRUE(does(Kind::press, {400, 300}, Button::right));
  EXPECT_TRUE(does(Kind::move, {550, 300}, Button::right));
  EXPECT_TRUE(does(Kind::release, {550, 300}, Button::right));
  EXPECT_EQ(Vec3(placing.finger()[3]), Vec3(before[3]));
  EXPECT_LT(glm::distance(Vec3(placing.finger()[1]), Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)), 1e-9)
      << "its body leans to the right";
  EXPECT_TRUE(key('z', true));
  EXPECT_EQ(placing.finger(), before);
}

TEST_F(PlacingTest, AHandleMovesASolidAndUndoTakesItBack) {
  EXPECT_FALSE(placing.moved());
  EXPECT_TRUE(key('g'));
  EXPECT_EQ(placing.chosen(), 0u);
  drag({-0.03, -0.01, 0});
  EXPECT_TRUE(does(Kind::release));
  EXPECT_TRUE(placing.moved());
  const Transform pose = placing.poses()[0];
  EXPECT_GT(pose[3].x, 1e-3);
  EXPECT_EQ(Vec2(pose[3].y, pose[3].z), Vec2(0, 0));
  EXPECT_EQ(placing.poses()[1], Transform(1.0));

  Picture picture = rest;
  pose_solids(picture, rest, placing.poses());
  EXPECT_EQ(picture.solids[0].mesh.positions[0].x, rest.solids[0].mesh.positions[0].x + pose[3].x);
  EXPECT_EQ(picture.solids[1].mesh.positions[0], rest.solids[1].mesh.positions[0]);
  EXPECT_EQ(*picture.tile, *rest.tile) << "it is on the other";

  drag(transform_point(pose, {-0.03, -0.01, 0}));
  EXPECT_NE(placing.poses()[0], pose);
  EXPECT_TRUE(key(Key::escape));
  EXPECT_EQ(placing.poses()[0], pose) << "Escape lets go of it where it was";
  EXPECT_TRUE(key('z', true));
  EXPECT_FALSE(placing.moved());
  EXPECT_TRUE(key(Key::escape)) << "hides the handles";
  EXPECT_FALSE(placing.chosen());
  EXPECT_FALSE(key(Key::escape)) << "nobody's here";
}

TEST_F(PlacingTest, EachSolidHasItsHandlesInItsOwnMiddleAndTurnsAroundIt) {
  for (std::size_t thing = 0; thing < 2; ++thing) {
    EXPECT_TRUE(key('g'));
    EXPECT_EQ(placing.chosen(), thing);
    for (const bool moved : {false, true}) {
      const Vec3 middle = transform_point(placing.poses()[thing], {thing == 0 ? -0.03 : 0.03, -0.01, 0});
      const Gizmo gizmo = gizmo_at(middle, sight);
      const auto shown = placing.marks(sight), expected = gizmo_marks(gizmo, sight, std::nullopt);
      ASSERT_EQ(shown.size(), expected.size());
      for (std::size_t i = 0; i < shown.size(); ++i)
        EXPECT_EQ(shown[i].points, expected[i].points) << thing << i;
      if (!moved) {
        drag(middle);
        does(Kind::release);
        does(Kind::move, {1, 1});
        continue;
      }
      const Vec2 ring = pixel(middle + 0.72 * gizmo.size_m * glm::normalize(Vec3(1, 2, 0)));
      EXPECT_TRUE(does(Kind::press, ring));
      EXPECT_TRUE(does(Kind::move, ring + Vec2(40, 0)));
      EXPECT_TRUE(does(Kind::release, ring + Vec2(40, 0)));
      const Transform& pose = placing.poses()[thing];
      EXPECT_GT(glm::distance(Vec3(pose[0]), Vec3(1, 0, 0)), 0.05) << "it is turned";
      EXPECT_LT(glm::distance(transform_point(pose, {thing == 0 ? -0.03 : 0.03, -0.01, 0}), middle), 1e-12) << thing;
    }
  }
}

TEST_F(PlacingTest, TheFingerHasHandlesAfterTheSolids) {
  for (int i = 0; i < 3; ++i)
    key('g');
  EXPECT_EQ(placing.chosen(), 2u);
  const Vec3 before = tip();
  does(Kind::move, {300, 200});
  EXPECT_EQ(tip(), before) << "it would run away from its handles";
  drag(before);
  EXPECT_GT(tip().x, before.x);
  key('g');
  EXPECT_FALSE(placing.chosen());
}

TEST_F(PlacingTest, WhatWasMovedStaysInItsScene) {
  key('g');
  drag({-0.03, -0.01, 0});
  does(Kind::release);
  placing.begin(rest, true, true);
  EXPECT_TRUE(placing.moved());
  EXPECT_TRUE(placing.can_undo());
  placing.begin(rest, false, false);
  EXPECT_FALSE(placing.moved() || placing.chosen());
  EXPECT_EQ(placing.names().size(), 2u) << "no finger is held any more";
  EXPECT_FALSE(placing.can_undo()) << "it was of the other scene";
  key('z', true);
  EXPECT_FALSE(placing.moved());
}

}  // namespace
}  // namespace palpa::viewer
