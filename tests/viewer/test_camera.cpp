#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "viewer/camera.hpp"

namespace palpa::viewer {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Camera, StandardViewsLookAlongTheAxes) {
  Camera camera;
  camera.target = {0.1, 0.2, 0.3};
  camera.distance = 2;
  look(camera, StandardView::front);
  EXPECT_LT(glm::distance(basis(camera).eye, Vec3(0.1, 0.2, 2.3)), 1e-12);
  EXPECT_LT(glm::distance(basis(camera).right, Vec3(1, 0, 0)), 1e-12);
  look(camera, StandardView::right);
  EXPECT_LT(glm::distance(basis(camera).eye, Vec3(2.1, 0.2, 0.3)), 1e-12);
  EXPECT_LT(glm::distance(basis(camera).right, Vec3(0, 0, -1)), 1e-12);
  look(camera, StandardView::top);
  EXPECT_LT(glm::distance(basis(camera).eye, Vec3(0.1, 2.2, 0.3)), 1e-12);
  EXPECT_LT(glm::distance(basis(camera).up, Vec3(0, 0, -1)), 1e-12);
  EXPECT_EQ(value_of(view_words, "top"), StandardView::top);
  EXPECT_FALSE(value_of(view_words, "bottom"));
}

TEST(Camera, BasisIsOrthonormalAndRightHanded) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> angle(-pi, pi);
  for (int i = 0; i < 200; ++i) {
    Camera camera;
    camera.azimuth = angle(random);
    camera.elevation = angle(random) / 2;
    const Basis b = basis(camera);
    EXPECT_LT(glm::distance(glm::cross(b.right, b.up), -b.forward), 1e-12);
    EXPECT_NEAR(glm::length(b.forward), 1, 1e-12);
  }
}

TEST(Camera, LookFromAnEyeGivesThatEye) {
  Camera camera;
  for (const Vec3& eye : {Vec3(0.3, 0.1, -0.2), Vec3(0, 0.5, 0), Vec3(0, -0.5, 0), Vec3(-1, 0, 0)}) {
    look(camera, eye, Vec3(0.01, 0, 0.02));
    EXPECT_LT(glm::distance(basis(camera).eye, eye), 1e-9) << eye.x << " " << eye.y << " " << eye.z;
  }
}

TEST(Camera, ProjectsAsAPinholeDoes) {
  Camera camera;
  look(camera, StandardView::front);
  camera.target = {0, 0, 0};
  camera.distance = 0.5;
  const auto view = projection(camera, 800, 600);
  const double focal = 300 / std::tan(camera.fov / 2);
  const Projected centre = project(view, {0, 0, 0});
  EXPECT_NEAR(centre.x, 400, 1e-3);
  EXPECT_NEAR(centre.y, 300, 1e-3);
  EXPECT_NEAR(centre.depth, 0.5, 1e-6);
  const Projected p = project(view, {0.03, 0.05, 0.1});  // 0.4 m before the eye
  EXPECT_NEAR(p.x, 400 + focal * 0.03 / 0.4, 1e-2);
  EXPECT_NEAR(p.y, 300 - focal * 0.05 / 0.4, 1e-2);
  EXPECT_FALSE(project(view, {0, 0, 1}).visible);
  // Depth grows towards the viewer.
  const auto depth = [&](const Vec3& v) { return view.clip_z.w / (view.clip_w.z * v.z + view.clip_w.w); };
  EXPECT_GT(depth({0, 0, 0.1}), depth({0, 0, 0}));
}

TEST(Camera, ParallelProjectionShowsTheTargetAsLarge) {
  Camera camera;
  const double size = metres_per_pixel(camera, 600);
  for (const bool orthographic : {false, true}) {
    camera.orthographic = orthographic;
    const auto view = projection(camera, 800, 600);
    const Basis b = basis(camera);
    const Projected p = project(view, camera.target + b.up * (100 * size));
    EXPECT_NEAR(p.y, 200, 1e-2) << orthographic;
    EXPECT_NEAR(p.x, 400, 1e-2) << orthographic;
    const Projected nearer = project(view, camera.target - b.forward * 0.01);
    EXPECT_LT(nearer.depth, project(view, camera.target).depth);
  }
}

TEST(Camera, AShiftedLensMovesThePictureWithoutTurningIt) {
  Camera camera;
  const auto straight = projection(camera, 800, 600);
  camera.shift = -0.25;
  const auto shifted = projection(camera, 800, 600);
  for (const Vec3& p : {Vec3(0), Vec3(0.03, 0.01, -0.02)}) {
    EXPECT_NEAR(project(shifted, p).x, project(straight, p).x - 100, 1e-2);
    EXPECT_NEAR(project(shifted, p).y, project(straight, p).y, 1e-3);
  }
}

TEST(Camera, FrameFitsTheBoxWithAMargin) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-0.3, 0.3), angle(-pi, pi);
  for (int i = 0; i < 100; ++i) {
    Box box;
    box.add({place(random), place(random), place(random)});
    box.add({place(random), place(random), place(random)});
    Camera camera;
    camera.orthographic = i % 2;
    camera.azimuth = angle(random);
    camera.elevation = angle(random) / 2;
    frame(camera, box, 1.5);
    const auto view = projection(camera, 900, 600);
    double widest = 0;
    for (int c = 0; c < 8; ++c) {
      const Projected p = project(
          view, {c & 1 ? box.high.x : box.low.x, c & 2 ? box.high.y : box.low.y, c & 4 ? box.high.z : box.low.z});
      ASSERT_TRUE(p.visible);
      widest = std::max({widest, std::abs(p.x - 450) / 450, std::abs(p.y - 300) / 300});
    }
    EXPECT_LT(widest, 0.95);
    EXPECT_GT(widest, 0.6);
  }
  Camera camera;
  frame(camera, Box{}, 1.5);
  EXPECT_TRUE(std::isfinite(camera.distance));
  Box point;
  point.add({1, 2, 3});
  frame(camera, point, 1.5);
  EXPECT_EQ(camera.target, Vec3(1, 2, 3));
  EXPECT_GT(camera.distance, 0.01);
}

TEST(Camera, StaysUsableUnderWildMovement) {
  Camera camera;
  for (int i = 0; i < 1000; ++i) {
    orbit(camera, 337, i % 2 ? 5000 : -900, 600);
    zoom(camera, i < 500 ? 30 : -30);
    ASSERT_GE(camera.elevation, -pi / 2);
    ASSERT_LE(camera.elevation, pi / 2);
    ASSERT_GT(camera.distance, 0);
    ASSERT_LT(camera.distance, 1000);
    ASSERT_LE(std::abs(camera.azimuth), pi);
  }
}

}  // namespace
}  // namespace palpa::viewer
