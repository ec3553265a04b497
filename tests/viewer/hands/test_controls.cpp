#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numbers>
#include <tuple>

#include "viewer/hands/controls.hpp"

namespace palpa::viewer {
namespace {

using Kind = WindowEvent::Kind;

struct Hands {
  Viewpoint viewpoint;
  Controls controls;
  Box home;

  Hands() {
    home.add({-0.02, -0.02, -0.02});
    home.add({0.02, 0.02, 0.02});
  }
  Reply send(const WindowEvent& event) { return controls.handle(event, viewpoint, home, 800, 600); }
  Reply send(Kind kind, double x, double y) { return send({.kind = kind, .x = x, .y = y}); }
  Reply press(Key key, bool ctrl = false) { return send({.kind = Kind::key, .ctrl = ctrl, .key = key}); }
};

TEST(Controls, LeftDragOrbits) {
  Hands hands;
  const Viewpoint before = hands.viewpoint;
  EXPECT_EQ(hands.send(Kind::move, 300, 300), Reply::nothing);  // no button yet
  EXPECT_EQ(hands.viewpoint.azimuth, before.azimuth);
  hands.send(Kind::press, 100, 100);
  EXPECT_EQ(hands.send(Kind::move, 250, 100), Reply::redraw);
  EXPECT_NEAR(hands.viewpoint.azimuth, before.azimuth - std::numbers::pi / 4, 1e-12);
  EXPECT_EQ(hands.send(Kind::move, 250, 130), Reply::redraw);
  EXPECT_NEAR(hands.viewpoint.elevation, before.elevation + std::numbers::pi / 20, 1e-12);
  EXPECT_EQ(hands.viewpoint.target, before.target);
  hands.send(Kind::release, 250, 130);
  EXPECT_EQ(hands.send(Kind::move, 0, 0), Reply::nothing);
}

TEST(Controls, MiddleAndShiftDragPanSoThatTheTargetFollowsTheMouse) {
  for (const bool shift : {false, true}) {
    Hands hands;
    const Vec3 before = hands.viewpoint.target;
    const double azimuth = hands.viewpoint.azimuth;
    hands.send(
        {.kind = Kind::press, .x = 400, .y = 300, .button = shift ? Button::left : Button::middle, .shift = shift});
    EXPECT_EQ(hands.send(Kind::move, 437, 281), Reply::redraw);
    EXPECT_EQ(hands.viewpoint.azimuth, azimuth);
    const Projected old = project(projection(hands.viewpoint, 800, 600), before);
    EXPECT_NEAR(old.x, 437, 0.1);
    EXPECT_NEAR(old.y, 281, 0.1);
  }
}

TEST(Controls, WheelZoomsTowardsThePointer) {
  for (const bool orthographic : {false, true}) {
    Hands hands;
    hands.viewpoint.orthographic = orthographic;
    const Viewpoint before = hands.viewpoint;
    const double scale = metres_per_pixel(before, 600);
    const Basis b = basis(before);
    const Vec3 under = before.target + (b.right * 130.0 - b.up * 70.0) * scale;
    EXPECT_EQ(hands.send({.kind = Kind::scroll, .x = 530, .y = 370, .steps = 3}), Reply::redraw);
    EXPECT_LT(hands.viewpoint.distance, before.distance);
    const Projected there = project(projection(hands.viewpoint, 800, 600), under);
    EXPECT_NEAR(there.x, 530, 0.1);
    EXPECT_NEAR(there.y, 370, 0.1);
    hands.send({.kind = Kind::scroll, .x = 530, .y = 370, .steps = -3});
    EXPECT_NEAR(hands.viewpoint.distance, before.distance, 1e-12);
    EXPECT_LT(glm::distance(hands.viewpoint.target, before.target), 1e-9);
  }
}

TEST(Controls, KeysTurnTheViewToTheAxesAndFrameEverything) {
  Hands hands;
  for (const auto& [key, ctrl, forward] : {std::tuple('1', false, Vec3(0, 0, -1)),
                                           {'3', false, Vec3(-1, 0, 0)},
                                           {'7', false, Vec3(0, -1, 0)},
                                           {'1', true, Vec3(0, 0, 1)}}) {
    EXPECT_EQ(hands.press(key_of(key), ctrl), Reply::redraw);
    EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, forward), 1e-12) << key << ctrl;
  }
  EXPECT_EQ(hands.send({.kind = Kind::key, .key = key_of('1'), .down = false}), Reply::nothing) << "let go of";
  hands.press(key_of('5'));
  EXPECT_TRUE(hands.viewpoint.orthographic);
  hands.viewpoint.target = {5, 5, 5};
  hands.press(key_of('f'));
  EXPECT_EQ(hands.viewpoint.target, Vec3(0));
  for (const Key other : {Key::space, Key::other})
    EXPECT_EQ(hands.press(other), Reply::nothing);
}

}  // namespace
}  // namespace palpa::viewer
