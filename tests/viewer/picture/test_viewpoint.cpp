#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <tuple>

#include "viewer/view/viewpoint.hpp"

namespace palpa::viewer {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Viewpoint, StandardViewsLookAlongTheAxes) {
  Viewpoint viewpoint;
  viewpoint.target = {0.1, 0.2, 0.3};
  viewpoint.distance = 2;
  for (const auto& [view, eye, right] : {std::tuple(StandardView::front, Vec3(0, 0, 2), Vec3(1, 0, 0)),
                                         {StandardView::right, Vec3(2, 0, 0), Vec3(0, 0, -1)},
                                         {StandardView::top, Vec3(0, 2, 0), Vec3(1, 0, 0)}}) {
    look(viewpoint, view);
    EXPECT_LT(glm::distance(basis(viewpoint).eye, viewpoint.target + eye), 1e-12);
    EXPECT_LT(glm::distance(basis(viewpoint).right, right), 1e-12);
  }
  EXPECT_EQ(value_of(view_words, "top"), StandardView::top);
  EXPECT_FALSE(value_of(view_words, "bottom"));
}

TEST(Viewpoint, ItsBasisIsOrthonormalRightHandedAndAtTheEyeThatWasAskedFor) {
  for (const Vec3& eye : {Vec3(0.3, 0.1, -0.2), Vec3(0, 0.5, 0), Vec3(0, -0.5, 0), Vec3(-1, 0, 0)}) {
    Viewpoint viewpoint;
    look(viewpoint, eye, Vec3(0.01, 0, 0.02));
    EXPECT_LT(glm::distance(basis(viewpoint).eye, eye), 1e-9) << eye.x << " " << eye.y << " " << eye.z;
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-pi, pi);
  for (int i = 0; i < 200; ++i) {
    Viewpoint viewpoint;
    viewpoint.azimuth = angle(random);
    viewpoint.elevation = angle(random) / 2;
    const Basis b = basis(viewpoint);
    EXPECT_LT(glm::distance(glm::cross(b.right, b.up), -b.forward), 1e-12);
    EXPECT_NEAR(glm::length(b.forward), 1, 1e-12);
  }
}

TEST(Viewpoint, ThroughACameraItSeesWhatTheCameraSees) {
  // Held upside down, looking along +x; its optical axis is not in the image's middle.
  sensing::Camera camera;
  camera.width = 800;
  camera.height = 600;
  camera.fx = camera.fy = 700;
  camera.cx = 310;
  camera.cy = 340;
  Transform& T_world_camera = camera.T_world_camera;
  T_world_camera[0] = Vec4(0, 0, -1, 0);
  T_world_camera[1] = Vec4(0, 1, 0, 0);
  T_world_camera[2] = Vec4(1, 0, 0, 0);
  T_world_camera[3] = Vec4(-0.4, 0.1, 0.2, 1);
  Viewpoint viewpoint;
  look(viewpoint, through(camera), Vec3(T_world_camera * Vec4(0.1, 0.2, 0.5, 1)));
  EXPECT_NEAR(viewpoint.distance, 0.5, 1e-12);
  for (const Vec3& at : {Vec3(0.03, 0.02, 0.4), Vec3(-0.1, -0.15, 0.3), Vec3(0.2, 0.1, 0.7)}) {
    const Vec3 world = transform_point(T_world_camera, at);
    const Vec2 pixel = sensing::project(camera, at);
    const Projected p = project(projection(viewpoint, 800, 600), world);
    // Pixel centres are whole numbers in the camera, and half-integers in a picture.
    EXPECT_NEAR(p.x, pixel.x + 0.5, 1e-3);
    EXPECT_NEAR(p.y, pixel.y + 0.5, 1e-3);
    EXPECT_NEAR(p.depth, at.z, 1e-6);
    // A wider picture shows more on both sides at the same size. A narrower one is smaller and shows more above.
    const Projected wide = project(projection(viewpoint, 1000, 600), world);
    EXPECT_NEAR(wide.x, pixel.x + 0.5 + 100, 1e-3);
    EXPECT_NEAR(wide.y, pixel.y + 0.5, 1e-3);
    EXPECT_NEAR(project(projection(viewpoint, 400, 600), world).x, (pixel.x + 0.5) / 2, 1e-3);
  }
  const Basis b = basis(viewpoint);
  EXPECT_LT(glm::distance(b.eye, Vec3(T_world_camera[3])), 1e-12);
  EXPECT_LT(glm::distance(b.up, Vec3(0, -1, 0)), 1e-12);
  // A drag continues from there; upside down, it turns in the same way as upright. A standard view uses the world's
  // axes again.
  Viewpoint still = viewpoint;
  orbit(still, 0, 0, 600);
  EXPECT_FALSE(still.frustum);
  EXPECT_LT(glm::distance(basis(still).eye, b.eye), 1e-12);
  orbit(viewpoint, 0, 600.0 / 4, 600);
  EXPECT_LT(glm::distance(basis(viewpoint).up, b.up), 0.8);
  look(viewpoint, StandardView::front);
  EXPECT_LT(glm::distance(basis(viewpoint).up, Vec3(0, 1, 0)), 1e-12);
}

TEST(Viewpoint, ProjectsAsAPinholeDoes) {
  Viewpoint viewpoint;
  look(viewpoint, StandardView::front);
  viewpoint.target = {0, 0, 0};
  viewpoint.distance = 0.5;
  const auto view = projection(viewpoint, 800, 600);
  const double focal = 300 / std::tan(viewpoint.fov / 2);
  const Projected centre = project(view, {0, 0, 0});
  EXPECT_NEAR(centre.x, 400, 1e-3);
  EXPECT_NEAR(centre.y, 300, 1e-3);
  EXPECT_NEAR(centre.depth, 0.5, 1e-6);
  const Projected p = project(view, {0.03, 0.05, 0.1});  // 0.4 m in front of the eye
  EXPECT_NEAR(p.x, 400 + focal * 0.03 / 0.4, 1e-2);
  EXPECT_NEAR(p.y, 300 - focal * 0.05 / 0.4, 1e-2);
  EXPECT_FALSE(project(view, {0, 0, 1}).visible);
  // Depth grows towards the viewer.
  const auto depth = [&](const Vec3& v) { return view.clip_z.w / (view.clip_w.z * v.z + view.clip_w.w); };
  EXPECT_GT(depth({0, 0, 0.1}), depth({0, 0, 0}));
}

TEST(Viewpoint, ParallelProjectionShowsTheTargetAsLarge) {
  Viewpoint viewpoint;
  const double size = metres_per_pixel(viewpoint, 600);
  for (const bool orthographic : {false, true}) {
    viewpoint.orthographic = orthographic;
    const auto view = projection(viewpoint, 800, 600);
    const Basis b = basis(viewpoint);
    const Projected p = project(view, viewpoint.target + b.up * (100 * size));
    EXPECT_NEAR(p.y, 200, 1e-2) << orthographic;
    EXPECT_NEAR(p.x, 400, 1e-2) << orthographic;
    const Projected nearer = project(view, viewpoint.target - b.forward * 0.01);
    EXPECT_LT(nearer.depth, project(view, viewpoint.target).depth);
  }
}

TEST(Viewpoint, AShiftedLensMovesThePictureWithoutTurningIt) {
  Viewpoint viewpoint;
  const auto straight = projection(viewpoint, 800, 600);
  viewpoint.covered_right = 0.25;
  const auto shifted = projection(viewpoint, 800, 600);
  for (const Vec3& p : {Vec3(0), Vec3(0.03, 0.01, -0.02)}) {
    EXPECT_NEAR(project(shifted, p).x, project(straight, p).x - 100, 1e-2);
    EXPECT_NEAR(project(shifted, p).y, project(straight, p).y, 1e-3);
  }
  viewpoint.covered_right = 0;
  viewpoint.covered_below = 0.25;
  const auto raised = projection(viewpoint, 800, 600);
  EXPECT_NEAR(project(raised, Vec3(0.03, 0.01, -0.02)).y, project(straight, Vec3(0.03, 0.01, -0.02)).y - 75, 1e-2);
}

TEST(Viewpoint, FrameFitsTheBoxWithAMarginBesideWhatCoversThePicture) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-0.3, 0.3), angle(-pi, pi);
  for (int i = 0; i < 100; ++i) {
    Box box;
    box.add({place(random), place(random), place(random)});
    box.add({place(random), place(random), place(random)});
    Viewpoint viewpoint;
    viewpoint.orthographic = i % 2;
    viewpoint.azimuth = angle(random);
    viewpoint.elevation = angle(random) / 2;
    viewpoint.covered_left = 0.1 * (i % 3);
    viewpoint.covered_right = 0.1 * (i % 5);
    viewpoint.covered_below = 0.1 * (i % 4);
    fit(viewpoint, box, 1.5);
    const auto view = projection(viewpoint, 900, 600);
    const double middle = 450 * (1 + viewpoint.covered_left - viewpoint.covered_right);
    const double half = 450 * (1 - viewpoint.covered_left - viewpoint.covered_right);
    const double up = 300 * (1 - viewpoint.covered_below);
    double widest = 0;
    for (int c = 0; c < 8; ++c) {
      const Projected p = project(
          view, {c & 1 ? box.high.x : box.low.x, c & 2 ? box.high.y : box.low.y, c & 4 ? box.high.z : box.low.z});
      ASSERT_TRUE(p.visible);
      widest = std::max({widest, std::abs(p.x - middle) / half, std::abs(p.y - up) / up});
    }
    EXPECT_LT(widest, 0.95);
    EXPECT_GT(widest, 0.6);
  }
  Viewpoint viewpoint;
  fit(viewpoint, Box{}, 1.5);
  EXPECT_TRUE(std::isfinite(viewpoint.distance));
  Box point;
  point.add({1, 2, 3});
  fit(viewpoint, point, 1.5);
  EXPECT_EQ(viewpoint.target, Vec3(1, 2, 3));
  EXPECT_GT(viewpoint.distance, 0.01);
}

TEST(Viewpoint, WhatCoversThePictureFromBelowHidesNothingOfIt) {
  Viewpoint viewpoint;
  const Vec3 top = viewpoint.target + 0.05 * basis(viewpoint).up;
  const double from_middle = 300 - project(projection(viewpoint, 800, 600), top).y;
  cover_below(viewpoint, 0.2, false);
  const auto view = projection(viewpoint, 800, 600);
  EXPECT_NEAR(project(view, viewpoint.target).y, 240, 1e-2);
  EXPECT_NEAR(240 - project(view, top).y, 0.8 * from_middle, 0.02 * from_middle);
  const double distance = viewpoint.distance;
  cover_below(viewpoint, 0, true);
  EXPECT_EQ(viewpoint.distance, distance) << "an eye that was given stays where it is";
  EXPECT_NEAR(project(projection(viewpoint, 800, 600), viewpoint.target).y, 300, 1e-2);
}

TEST(Viewpoint, StaysUsableUnderWildMovement) {
  Viewpoint viewpoint;
  for (int i = 0; i < 1000; ++i) {
    orbit(viewpoint, 337, i % 2 ? 5000 : -900, 600);
    zoom(viewpoint, i < 500 ? 30 : -30);
    ASSERT_GE(viewpoint.elevation, -pi / 2);
    ASSERT_LE(viewpoint.elevation, pi / 2);
    ASSERT_GT(viewpoint.distance, 0);
    ASSERT_LT(viewpoint.distance, 1000);
    ASSERT_LE(std::abs(viewpoint.azimuth), pi);
  }
}

}  // namespace
}  // namespace palpa::viewer
