// Handles: their places, and the effect of dragging them.
#include "viewer/hands/gizmo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace palpa::viewer {
namespace {

Sight sight_from(double azimuth, double elevation, bool orthographic) {
  Sight sight{.viewpoint = {}, .width = 800, .height = 600, .ratio = 1};
  sight.viewpoint.azimuth = azimuth;
  sight.viewpoint.elevation = elevation;
  sight.viewpoint.orthographic = orthographic;
  sight.viewpoint.covered_right = 0.2;
  return sight;
}

Vec2 pixel(const Sight& sight, const Vec3& p) {
  const Projected at = project(projection(sight.viewpoint, sight.width, sight.height), p);
  return {at.x, at.y};
}

TEST(LineOfSight, MeetsNoPlaneThatItRunsAlong) {
  EXPECT_FALSE(meet({{0, 1, 0}, {1, 0, 0}}, {0, 0, 0}, {0, 1, 0}));
  EXPECT_FALSE(meet({{0, 1, 0}, {0, 1, 0}}, {0, 0, 0}, {0, 1, 0})) << "behind it";
  const auto at = meet({{1, 1, 2}, {0, -1, 0}}, {0, -3, 0}, {0, 2, 0});
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, Vec3(1, -3, 2));
}

/// Two places on each handle of a gizmo of size 1 around the origin; a drag may end at the second one.
struct Way {
  Handle handle;
  Vec3 from, to;
};
std::vector<Way> ways() {
  const double r = 0.72;
  const auto on_ring = [&](double turn) { return Vec2(r * std::cos(turn), r * std::sin(turn)); };
  const Vec2 a = on_ring(0.5), b = on_ring(1.3);
  return {{Handle::along_x, {0.8, 0, 0}, {1.3, 0, 0}},      {Handle::along_y, {0, 0.8, 0}, {0, 0.2, 0}},
          {Handle::along_z, {0, 0, 0.8}, {0, 0, 1.1}},      {Handle::in_yz, {0, 0.35, 0.3}, {0, 0.6, -0.2}},
          {Handle::in_zx, {0.4, 0, 0.3}, {-0.4, 0, 0.6}},   {Handle::in_xy, {0.3, 0.4, 0}, {0.5, 0.9, 0}},
          {Handle::around_x, {0, a.x, a.y}, {0, b.x, b.y}}, {Handle::around_y, {a.y, 0, a.x}, {b.y, 0, b.x}},
          {Handle::around_z, {a.x, a.y, 0}, {b.x, b.y, 0}}};
}

TEST(Gizmo, WhatIsGrippedGoesWithThePointer) {
  for (const bool orthographic : {false, true}) {
    const Sight sight = sight_from(0.6, 0.45, orthographic);
    const Gizmo gizmo = gizmo_at({0.01, -0.02, 0.015}, sight);
    for (const Way& way : ways()) {
      const Vec3 from = gizmo.at + gizmo.size_m * way.from, to = gizmo.at + gizmo.size_m * way.to;
      const Vec2 at = pixel(sight, from);
      EXPECT_EQ(handle_at(gizmo, sight, at.x, at.y), way.handle) << static_cast<int>(way.handle);
      const auto motion = dragged(gizmo, way.handle, sight, at, pixel(sight, to), false);
      ASSERT_TRUE(motion) << static_cast<int>(way.handle);
      EXPECT_LT(glm::distance(transform_point(*motion, from), to), 1e-6) << static_cast<int>(way.handle);
      if (way.handle >= Handle::around_x) {
        EXPECT_LT(glm::distance(transform_point(*motion, gizmo.at), gizmo.at), 1e-12) << "turns around its middle";
      }
    }
  }
}

TEST(Gizmo, SnapsToMillimetresAndFiveDegrees) {
  const Sight sight = sight_from(0.6, 0.45, false);
  const Gizmo gizmo = gizmo_at({0, 0, 0}, sight);
  for (const Way& way : ways()) {
    const Vec2 from = pixel(sight, gizmo.size_m * way.from), to = pixel(sight, gizmo.size_m * way.to);
    const Transform motion = *dragged(gizmo, way.handle, sight, from, to, true);
    if (way.handle < Handle::around_x) {
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(motion[3][i], std::round(motion[3][i] * 1e3) * 1e-3, 1e-12);
    } else {
      const double angle = std::acos((motion[0][0] + motion[1][1] + motion[2][2] - 1) / 2) * 180 / std::numbers::pi;
      EXPECT_NEAR(angle, 45, 1e-6) << "0.8 rad";
    }
  }
}

TEST(Gizmo, IsAsLargeInEveryPicture) {
  Sight sight = sight_from(0, 0, true);
  for (const double distance : {0.1, 0.3, 2.0}) {
    sight.viewpoint.distance = distance;
    for (const double ratio : {1.0, 2.0}) {
      sight.ratio = ratio;
      const Gizmo gizmo = gizmo_at({0, 0, 0}, sight);
      const double pixels = glm::distance(pixel(sight, {0, 0, 0}), pixel(sight, {gizmo.size_m, 0, 0}));
      EXPECT_NEAR(pixels, 78 * ratio, 0.1);
    }
  }
}

TEST(Gizmo, ARingIsGrippedAllAround) {
  const Sight sight = sight_from(0, 0, true);
  const Gizmo gizmo = gizmo_at({0, 0, 0}, sight);
  for (int i = 0; i < 16; ++i) {
    const double turn = 2 * std::numbers::pi * (i + 0.5) / 16, r = 0.72 * gizmo.size_m;
    const Vec2 at = pixel(sight, {r * std::cos(turn), r * std::sin(turn), 0});
    EXPECT_EQ(handle_at(gizmo, sight, at.x, at.y), Handle::around_z) << i;
  }
}

TEST(Gizmo, AnArrowSeenFromItsEndDoesNotMove) {
  const Sight sight = sight_from(0, 0, true);  // along -z
  const Gizmo gizmo = gizmo_at({0, 0, 0}, sight);
  EXPECT_FALSE(dragged(gizmo, Handle::along_z, sight, {400, 300}, {420, 300}, false));
  EXPECT_FALSE(dragged(gizmo, Handle::around_x, sight, {400, 300}, {420, 300}, false)) << "a ring seen from its side";
  EXPECT_FALSE(handle_at(gizmo, sight, 5, 5));
}

TEST(Gizmo, DrawsNothingOfWhatIsBehindTheEye) {
  const Sight sight = sight_from(0, 0, false);
  EXPECT_TRUE(gizmo_marks(gizmo_at({0, 0, 5}, sight), sight, std::nullopt).empty());
  EXPECT_FALSE(gizmo_marks(gizmo_at({0, 0, 0}, sight), sight, std::nullopt).empty());
}

}  // namespace
}  // namespace palpa::viewer
