#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numbers>

#include "viewer/hands/controls.hpp"

namespace palpa::viewer {
namespace {

struct Hands {
  Viewpoint viewpoint;
  Controls controls;
  Box home;

  Hands() {
    home.add({-0.02, -0.02, -0.02});
    home.add({0.02, 0.02, 0.02});
  }
  Reply send(WindowEvent::Kind kind, double x = 0, double y = 0, Button button = Button::left, bool shift = false) {
    WindowEvent event;
    event.kind = kind;
    event.x = x;
    event.y = y;
    event.button = button;
    event.shift = shift;
    return controls.handle(event, viewpoint, home, 800, 600);
  }
  Reply press(Key key) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::key;
    event.key = key;
    return controls.handle(event, viewpoint, home, 800, 600);
  }
};

using Kind = WindowEvent::Kind;

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
    hands.send(Kind::press, 400, 300, shift ? Button::left : Button::middle, shift);
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
    WindowEvent event;
    event.kind = Kind::scroll;
    event.x = 530;
    event.y = 370;
    event.steps = 3;
    EXPECT_EQ(hands.controls.handle(event, hands.viewpoint, hands.home, 800, 600), Reply::redraw);
    EXPECT_LT(hands.viewpoint.distance, before.distance);
    const Projected there = project(projection(hands.viewpoint, 800, 600), under);
    EXPECT_NEAR(there.x, 530, 0.1);
    EXPECT_NEAR(there.y, 370, 0.1);
    event.steps = -3;
    hands.controls.handle(event, hands.viewpoint, hands.home, 800, 600);
    EXPECT_NEAR(hands.viewpoint.distance, before.distance, 1e-12);
    EXPECT_LT(glm::distance(hands.viewpoint.target, before.target), 1e-9);
  }
}

TEST(Controls, Keys) {
  Hands hands;
  EXPECT_EQ(hands.press(key_of('1')), Reply::redraw);
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(0, 0, -1)), 1e-12);
  hands.press(key_of('3'));
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(-1, 0, 0)), 1e-12);
  hands.press(key_of('7'));
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(0, -1, 0)), 1e-12);
  WindowEvent back;
  back.kind = Kind::key;
  back.key = key_of('1');
  back.ctrl = true;
  hands.controls.handle(back, hands.viewpoint, hands.home, 800, 600);
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(0, 0, 1)), 1e-12) << "from behind";
  back.ctrl = back.down = false;
  EXPECT_EQ(hands.controls.handle(back, hands.viewpoint, hands.home, 800, 600), Reply::nothing) << "let go of";
  hands.press(key_of('5'));
  EXPECT_TRUE(hands.viewpoint.orthographic);
  hands.viewpoint.target = {5, 5, 5};
  hands.press(key_of('f'));
  EXPECT_EQ(hands.viewpoint.target, Vec3(0));
  EXPECT_EQ(hands.press(Key::space), Reply::nothing);
  EXPECT_EQ(hands.press(Key::other), Reply::nothing);
}

}  // namespace
}  // namespace palpa::viewer
