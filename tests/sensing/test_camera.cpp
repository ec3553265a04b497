#include "sensing/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <span>

#include "pixel_rays.hpp"
#include "random_rig.hpp"
#include "sensing/rays.hpp"

namespace palpa::sensing {
namespace {

/// cv::projectPoints' formulas as in its documentation, in long double, without code from camera.cpp.
std::array<long double, 2> opencv_project(const Camera& camera, long double x, long double y) {
  const auto& d = camera.distortion;
  const long double k1 = d[0], k2 = d[1], p1 = d[2], p2 = d[3], k3 = d[4];
  const long double r = std::sqrt(x * x + y * y);
  const long double factor = 1 + k1 * std::pow(r, 2.0L) + k2 * std::pow(r, 4.0L) + k3 * std::pow(r, 6.0L);
  const long double xx = x * factor + 2 * p1 * x * y + p2 * (r * r + 2 * x * x);
  const long double yy = y * factor + p1 * (r * r + 2 * y * y) + 2 * p2 * x * y;
  return {camera.fx * xx + camera.cx, camera.fy * yy + camera.cy};
}

TEST(Camera, ProjectsAsOpenCvDocumentsIt) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = test::random_camera(random);
    const double x = unit(random), y = unit(random), z = 0.1 + std::abs(unit(random));
    const auto wanted = opencv_project(camera, x, y);
    const Vec2 got = project(camera, Vec3(x * z, y * z, z));
    EXPECT_NEAR(got.x, static_cast<double>(wanted[0]), 1e-9);
    EXPECT_NEAR(got.y, static_cast<double>(wanted[1]), 1e-9);
  }
}

TEST(Camera, UndistortsToWithinANanometreAtOneMetre) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  int inverted = 0, folded = 0;
  for (int i = 0; i < 20000; ++i) {
    const Camera camera = test::random_camera(random);
    // From a ray so near the axis that it is before any fold of these lenses.
    const double x = 0.5 * unit(random), y = 0.5 * unit(random);
    const auto pixel = opencv_project(camera, x, y);
    const Vec2 ray = test::undistort(camera, {static_cast<double>(pixel[0]), static_cast<double>(pixel[1])});
    ASSERT_NEAR(ray.x, x, 1e-9) << i;
    ASSERT_NEAR(ray.y, y, 1e-9) << i;
    // Any pixel: it has a ray that projects back to it, or none.
    const Vec2 any(camera.width * 1.5 * unit(random), camera.height * 1.5 * unit(random));
    const Vec2 found = test::undistort(camera, any);
    if (std::isnan(found.x)) {
      ++folded;
      continue;
    }
    const auto back = opencv_project(camera, found.x, found.y);
    ASSERT_NEAR(static_cast<double>(back[0]), any.x, 1e-6);
    ASSERT_NEAR(static_cast<double>(back[1]), any.y, 1e-6);
    ++inverted;
  }
  EXPECT_GT(inverted, 12000);
  EXPECT_GT(folded, 500);  // strong lenses do fold, and report it
}

TEST(Camera, APixelBeyondTheFoldHasNoRay) {
  Camera camera = test::d415(Transform(1.0));
  camera.distortion = {-0.5, 0, 0, 0, 0};  // r (1 - r^2/2) turns back at r = sqrt(2/3), image radius 0.5443
  const double edge = 2.0 / 3.0 * std::sqrt(2.0 / 3.0);
  EXPECT_NEAR(test::undistort(camera, {camera.cx + 640 * edge * 0.999, camera.cy}).x, 0.816, 0.03);
  EXPECT_TRUE(std::isnan(test::undistort(camera, {camera.cx + 640 * edge * 1.001, camera.cy}).x));
  // The corner of the image is beyond the fold: no ray there, and no point either.
  EXPECT_TRUE(std::isnan(test::undistort(camera, {0, 0}).y));
  const RayTables tables = make_rays(std::span(&camera, 1));
  EXPECT_EQ(tables.rays[0].x, no_ray);
  EXPECT_LT(tables.rays[240 * 848 + 424].x, 0.01f);
}

TEST(Camera, DeprojectionInvertsProjection) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const Camera camera = test::random_camera(random);
    const std::uint16_t depth = static_cast<std::uint16_t>(test::uniform(random, 1, 65535));
    const double z = depth * camera.depth_unit_m;
    const Vec3 point(0.4 * unit(random) * z, 0.4 * unit(random) * z, z);
    const Vec2 pixel = project(camera, point);
    const Vec3 world = test::deproject(camera, pixel.x, pixel.y, depth);
    EXPECT_LT(glm::length(world - transform_point(camera.T_world_camera, point)), 1e-8 * (1 + z));
  }
}

TEST(Camera, APinholesTablesAreThoseOfACameraWithARegionThatIsItsImage) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 30; ++i) {
    std::array<Camera, 2> cameras{test::random_camera(random)};
    see_all(cameras[0]);
    cameras[0].distortion.fill(0);
    cameras[1] = cameras[0];
    cameras[1].roi = PixelBox{0, 0, cameras[0].width, cameras[0].height};  // each pixel is looked at
    const RayTables tables = make_rays(cameras);
    const CameraTable &one = tables.cameras[0], &other = tables.cameras[1];
    ASSERT_TRUE(one.pinhole && !other.pinhole);
    EXPECT_EQ(one.reach, other.reach);
    const auto rays = std::span(tables.rays);
    const std::size_t pixels = std::size_t{one.pitch} * one.height;
    EXPECT_TRUE(std::ranges::equal(rays.subspan(one.first_pixel, pixels), rays.subspan(other.first_pixel, pixels)));
    const auto same = [](const RayBounds& a, const RayBounds& b) { return a.low == b.low && a.high == b.high; };
    EXPECT_TRUE(std::ranges::equal(one.tiles, other.tiles, same));
    EXPECT_TRUE(std::ranges::equal(one.tile_rows, other.tile_rows, same));
  }
}

TEST(Camera, TilesBoundTheirRaysExactly) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 30; ++i) {
    const Camera camera = test::random_camera(random);
    const RayTables tables = make_rays(std::span(&camera, 1));
    const CameraTable& table = tables.cameras[0];
    ASSERT_EQ(table.pitch % block_pixels, 0u);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
      for (std::uint32_t u = 0; u < camera.width; ++u) {
        const glm::vec2 ray = tables.rays[std::size_t{v} * table.pitch + u];
        const Vec2 exact = test::undistort(camera, {static_cast<double>(u), static_cast<double>(v)});
        if (ray.x == no_ray) {
          ASSERT_TRUE(std::isnan(exact.x));
          continue;
        }
        ASSERT_NEAR(ray.x, exact.x, 1e-6);
        const RayBounds& tile = table.tiles[(v / tile_pixels) * table.tiles_x + u / tile_pixels];
        ASSERT_TRUE(tile.low.x <= ray.x && ray.x <= tile.high.x && tile.low.y <= ray.y && ray.y <= tile.high.y);
      }
    }
  }
}

}  // namespace
}  // namespace palpa::sensing
