#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <numbers>

#include "viewer/controls.hpp"

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

TEST(Controls, WheelZooms) {
  Hands hands;
  const double before = hands.viewpoint.distance;
  EXPECT_EQ(hands.send(Kind::scroll, 0, 1), Reply::redraw);
  EXPECT_LT(hands.viewpoint.distance, before);
  hands.send(Kind::scroll, 0, -1);
  EXPECT_NEAR(hands.viewpoint.distance, before, 1e-12);
}

TEST(Controls, Keys) {
  Hands hands;
  EXPECT_EQ(hands.press(Key::one), Reply::redraw);
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(0, 0, -1)), 1e-12);
  hands.press(Key::three);
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(-1, 0, 0)), 1e-12);
  hands.press(Key::seven);
  EXPECT_LT(glm::distance(basis(hands.viewpoint).forward, Vec3(0, -1, 0)), 1e-12);
  hands.press(Key::five);
  EXPECT_TRUE(hands.viewpoint.orthographic);
  hands.viewpoint.target = {5, 5, 5};
  hands.press(Key::frame);
  EXPECT_EQ(hands.viewpoint.target, Vec3(0));
  EXPECT_EQ(hands.press(Key::space), Reply::toggle_pause);
  EXPECT_EQ(hands.press(Key::quit), Reply::quit);
  EXPECT_EQ(hands.press(Key::other), Reply::nothing);
}

}  // namespace
}  // namespace palpa::viewer
