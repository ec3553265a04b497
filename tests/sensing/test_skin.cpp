#include "sensing/skin_pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>

#include "base/error.hpp"
#include "pixel_rays.hpp"
#include "random_rig.hpp"
#include "sensing/skin_twin.hpp"
#include "shaders/sensing/skin.h"
#include "skin_run.hpp"
#include "spirv/skin_count.comp.hpp"
#include "spirv/skin_scatter.comp.hpp"
#include "support/barriers.hpp"
#include "support/spirv.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

using test_skin::DeviceResult;
using test_skin::random_scene;
using test_skin::run_pass;
using test_skin::run_twin;
using test_skin::same_bytes;
using test_skin::Scene;

double outside_by(const Box& box, const Vec3& p) {
  double worst = -1e300;
  for (int i = 0; i < 3; ++i)
    worst = std::max({worst, box.low[i] - p[i], p[i] - box.high[i]});
  return worst;
}

/// Every pixel's world point in double precision, camera after camera; NaN if it has none.
std::vector<Vec3> all_points(const Scene& scene) {
  std::vector<Vec3> points;
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const Camera& camera = scene.cameras[c];
    for (std::uint32_t v = 0; v < camera.height; ++v) {
      for (std::uint32_t u = 0; u < camera.width; ++u) {
        const std::uint16_t depth = scene.frames[c].depth[v * camera.width + u];
        const bool valid = depth != 0 && depth * camera.depth_unit_m >= camera.min_range_m - 1e-9;
        points.push_back(valid ? test::deproject(camera, u, v, depth) : Vec3(NAN));
      }
    }
  }
  return points;
}

/// Exactly the points inside the box, in order; only points within `band` of its faces may be in or out.
void expect_brute_force(const std::vector<Vec3>& all, const Box& box, const std::vector<SkinPoint>& found) {
  constexpr double band = 2e-6;
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double outside = std::isfinite(all[i].x) ? outside_by(box, all[i]) : 1;
    if (next < found.size() && found[next].index == i) {
      ASSERT_LE(outside, band) << "pixel " << i << " is not inside";
      ASSERT_LT(glm::length(all[i] - Vec3(found[next].position)), 1e-6) << "pixel " << i;
      ++next;
    } else {
      ASSERT_GE(outside, -band) << "missed pixel " << i;
    }
  }
  ASSERT_EQ(next, found.size());
}

TEST(Skin, TwinFindsWhatBruteForceInDoubleFindsForAnyBoxAndDistortion) {
  std::mt19937_64 random(7);
  std::size_t points = 0;
  for (int round = 0; round < 60; ++round) {
    const Scene scene = random_scene(random, test::uniform(random, 0, 3));
    const std::vector<Vec3> all = all_points(scene);
    const RayTables tables = make_rays(scene.cameras);
    std::vector<Crop> crops;
    std::vector<SkinPoint> found;
    for (int i = 0; i < 80; ++i) {
      const Box box = test::random_box(random);
      plan_crops(scene.cameras, tables, box, crops);
      find_skin(tables, scene.frames, box, crops, found);
      points += found.size();
      expect_brute_force(all, box, found);
      if (HasFatalFailure()) FAIL() << "round " << round;
    }
  }
  // The boxes are not simply empty. GCC and clang evaluate arguments in a different order, and draw different scenes.
  EXPECT_GT(points, 10000u);
}

TEST(Skin, DeviceGivesTheTwinsBytes) {
  std::mt19937_64 random(11);
  for (int round = 0; round < 25; ++round) {
    const Scene scene = random_scene(random, test::uniform(random, 1, 4));
    const Box box = test::random_box(random);
    const auto twin = find_skin(scene.cameras, scene.frames, box);
    const DeviceResult device = run_pass(scene, box);
    EXPECT_TRUE(same_bytes(twin, device.points))
        << "round " << round << ": " << twin.size() << " and " << device.points.size();
    EXPECT_EQ(device.total.groups_x, (twin.size() + 63) / 64);
    EXPECT_EQ(device.total.groups_y, 1u);
  }
}

TEST(MissingBarriers, AreSeenAfterTheKernelsOfTheSkin) {
  std::mt19937_64 random(11);
  const Scene scene = random_scene(random, 2);
  const Box box{Vec3(-100), Vec3(100)};
  for (const char* kernel : {"skin_count", "scan"}) {
    const test::NoBarrierAfter none(kernel);
    EXPECT_CONTAINS(test::error_of([&] { run_pass(scene, box); }, Exit::failed), std::string("which ") + kernel + " ");
  }
}

TEST(Skin, AStrideTakesEveryNthPixelOfEveryNthRow) {
  std::mt19937_64 random(23);
  std::size_t all_points = 0, kept_points = 0;
  for (int round = 0; round < 10; ++round) {
    const Scene scene = random_scene(random, test::uniform(random, 1, 4));
    Box box = test::random_box(random);
    if (round % 2 == 0) {
      box.add(Vec3(-2));
      box.add(Vec3(2));
    }
    const RayTables tables = make_rays(scene.cameras);
    const auto all = find_skin(scene.cameras, scene.frames, box);
    for (const std::uint32_t stride : {1u, 2u, 3u, 4u}) {
      std::vector<SkinPoint> expected;
      for (const SkinPoint& point : all) {
        std::size_t camera = 0;
        while (camera + 1 < tables.cameras.size() && point.index >= tables.cameras[camera + 1].first_index)
          ++camera;
        const auto place = static_cast<std::uint32_t>(point.index - tables.cameras[camera].first_index);
        const std::uint32_t width = tables.cameras[camera].width;
        if (place % width % stride == 0 && place / width % stride == 0) expected.push_back(point);
      }
      const std::vector<SkinPoint> twin = run_twin(scene, box, {.stride = stride}).points;
      EXPECT_TRUE(same_bytes(expected, twin)) << "round " << round << ", stride " << stride;
      EXPECT_TRUE(same_bytes(twin, run_pass(scene, box, {.stride = stride}).points)) << round << ", stride " << stride;
      if (stride == 3) kept_points += twin.size();
    }
    all_points += all.size();
  }
  EXPECT_GT(kept_points, 0u);
  EXPECT_NEAR(static_cast<double>(all_points) / static_cast<double>(kept_points), 9, 1.5);
}

TEST(Skin, TakesWholeImagesAndEmptyBoxes) {
  std::mt19937_64 random(3);
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    scene.cameras.push_back(test::d415(test::random_pose(random, 0.5)));
    scene.frames.push_back(test::random_frame(random, scene.cameras.back()));
  }
  const Box everything{Vec3(-1e300), Vec3(1e300)};
  const auto twin = find_skin(scene.cameras, scene.frames, everything);
  EXPECT_EQ(twin.size(), count_valid(scene.cameras, scene.frames));
  EXPECT_TRUE(same_bytes(twin, run_pass(scene, everything).points));

  EXPECT_TRUE(find_skin(scene.cameras, scene.frames, Box{}).empty());
  const DeviceResult none = run_pass(scene, Box{});
  EXPECT_EQ(none.total.total, 0u);
  EXPECT_EQ(none.total.groups_x, 0u);
  // A box that every camera has behind it or beyond its reach.
  EXPECT_EQ(run_pass(scene, Box{Vec3(100), Vec3(101)}).total.total, 0u);
}

/// A rectangle, a mask of noise, both or neither.
void ignore_some(std::mt19937_64& random, bool roi, bool mask, Camera& camera) {
  if (roi) {
    const std::uint32_t x = test::uniform(random, 0, camera.width - 1), y = test::uniform(random, 0, camera.height - 1);
    camera.roi = {x, y, test::uniform(random, x + 1, camera.width), test::uniform(random, y + 1, camera.height)};
  }
  if (!mask) return;
  Mask pixels{"mask.png", std::vector<std::uint8_t>(pixel_count(camera))};
  for (std::uint8_t& pixel : pixels.pixels)
    pixel = static_cast<std::uint8_t>(test::uniform(random, 0, 2) == 0 ? 0 : test::uniform(random, 1, 255));
  camera.mask = std::make_shared<Mask>(std::move(pixels));
}

TEST(Skin, IgnoredPixelsAreNoSkinAndTheOthersStayWhatTheyWere) {
  std::mt19937_64 random(29);
  std::size_t kept = 0, left_out = 0;
  for (int round = 0; round < 32; ++round) {
    Scene scene = random_scene(random, test::uniform(random, 1, 3));
    Box box = test::random_box(random);
    box = {box.low - Vec3(0.3), box.high + Vec3(0.3)};
    const auto all = find_skin(scene.cameras, scene.frames, box);
    std::vector<bool> ignored;
    std::uint64_t valid = 0;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      Camera& camera = scene.cameras[c];
      ignore_some(random, round & 1, round & 2, camera);
      EXPECT_EQ(ignores_pixels(camera), (round & 3) != 0);
      for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
          const bool outside =
              camera.roi && (u < camera.roi->x0 || u >= camera.roi->x1 || v < camera.roi->y0 || v >= camera.roi->y1);
          const std::size_t pixel = std::size_t{v} * camera.width + u;
          ignored.push_back(outside || (camera.mask && camera.mask->pixels[pixel] == 0));
          valid += !ignored.back() && scene.frames[c].depth[pixel] >= first_valid_depth(camera);
        }
      }
    }
    std::vector<SkinPoint> expected;
    std::ranges::copy_if(all, std::back_inserter(expected), [&](const SkinPoint& p) { return !ignored[p.index]; });
    const auto twin = find_skin(scene.cameras, scene.frames, box);
    EXPECT_TRUE(same_bytes(twin, expected)) << "round " << round;
    EXPECT_TRUE(same_bytes(twin, run_pass(scene, box).points)) << "round " << round;
    EXPECT_EQ(count_valid(scene.cameras, scene.frames), valid) << "round " << round;
    kept += expected.size();
    left_out += all.size() - expected.size();
  }
  EXPECT_GT(kept, 1000u);
  EXPECT_GT(left_out, 1000u);
}

TEST(Skin, TooLittleRoomKeepsTheFirstPointsAndStaysInside) {
  std::mt19937_64 random(5);
  const Scene scene = random_scene(random, 3);
  const Box box{Vec3(-2), Vec3(2)};
  auto twin = find_skin(scene.cameras, scene.frames, box);
  ASSERT_GT(twin.size(), 100u);
  twin.resize(100);
  const DeviceResult device = run_pass(scene, box, {.room = 100});
  EXPECT_EQ(device.total.total, 100u);
  EXPECT_TRUE(same_bytes(twin, device.points));
}

TEST(Skin, MovingRigAndBoxTogetherMovesThePoints) {
  // Turned by 90 degrees about z, so that the box remains a box.
  std::mt19937_64 random(13);
  const Transform motion(Vec4(0, 1, 0, 0), Vec4(-1, 0, 0, 0), Vec4(0, 0, 1, 0), Vec4(0.25, -0.5, 0.125, 1));
  for (int round = 0; round < 20; ++round) {
    Scene scene = random_scene(random, 2);
    const Box box = test::random_box(random);
    const auto before = find_skin(scene.cameras, scene.frames, box);
    Box moved;
    moved.add(transform_point(motion, box.low));
    moved.add(transform_point(motion, box.high));
    for (Camera& camera : scene.cameras)
      camera.T_world_camera = motion * camera.T_world_camera;
    const auto after = find_skin(scene.cameras, scene.frames, moved);
    std::set<std::uint32_t> indices;
    for (const SkinPoint& point : after)
      indices.insert(point.index);
    std::size_t shared = 0;
    for (const SkinPoint& point : before)
      shared += indices.count(point.index);
    EXPECT_LE(before.size() - shared, before.size() / 500);  // only those on the box's faces may change sides
    for (std::size_t i = 0; before.size() == after.size() && i < before.size(); ++i) {
      if (before[i].index != after[i].index) continue;
      EXPECT_LT(glm::length(transform_point(motion, Vec3(before[i].position)) - Vec3(after[i].position)), 2e-6);
    }
  }
}

TEST(Skin, ReorderingTheCamerasReordersThePoints) {
  std::mt19937_64 random(17);
  const Scene scene = random_scene(random, 2);
  const Scene swapped{{scene.cameras[1], scene.cameras[0]}, {scene.frames[1], scene.frames[0]}};
  const Box box{Vec3(-0.5), Vec3(0.5)};
  const auto a = find_skin(scene.cameras, scene.frames, box);
  const auto b = find_skin(swapped.cameras, swapped.frames, box);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  const auto first = static_cast<std::uint32_t>(pixel_count(scene.cameras[0]));
  const auto split = std::find_if(a.begin(), a.end(), [&](const SkinPoint& p) { return p.index >= first; }) - a.begin();
  for (std::size_t i = 0; i < a.size(); ++i) {
    const SkinPoint& other = b[(i + a.size() - split) % a.size()];
    EXPECT_EQ(a[i].position, other.position);
  }
}

TEST(Skin, NearestRangeIsAWholeStep) {
  Camera camera = test::d415(Transform(1.0));
  EXPECT_EQ(first_valid_depth(camera), 2800u);
  camera.min_range_m = 0;
  EXPECT_EQ(first_valid_depth(camera), 1u);
  camera.min_range_m = 0.28004;
  EXPECT_EQ(first_valid_depth(camera), 2801u);
  camera.min_range_m = 1000;
  EXPECT_EQ(first_valid_depth(camera), 65536u);
}

TEST(Skin, FramesThatDoNotFitAreRefused) {
  std::mt19937_64 random(19);
  Scene scene = random_scene(random, 2);
  scene.frames[1].depth.pop_back();
  const RayTables tables = make_rays(scene.cameras);
  std::vector<std::uint16_t> packed(tables.padded_pixels);
  EXPECT_ERROR(pack_depth(tables, scene.frames, packed), Exit::usage,
               "depth frame 1 has " + std::to_string(scene.frames[1].depth.size()) + " pixels");
  EXPECT_ERROR(find_skin(scene.cameras, scene.frames, Box{}), Exit::usage,
               "depth frame 1 has 9201 pixels, but its camera has 107x86");
  scene.frames.pop_back();
  EXPECT_ERROR(pack_depth(tables, scene.frames, packed), Exit::usage, "1 depth frame for 2 cameras");
  Camera huge = test::d415(Transform(1.0));
  huge.width = huge.height = 16384;
  EXPECT_ERROR(make_rays(std::span(&huge, 1)), Exit::usage, "268435456 pixels");
}

TEST(Skin, ShadersAgreeWithTheSharedHeader) {
  for (const gpu::Kernel* kernel : {&spirv::skin_count_comp, &spirv::skin_scatter_comp}) {
    const test::SpirvModule module = test::read_spirv(*kernel);
    EXPECT_EQ(module.local_size, (std::array<std::uint32_t, 3>{shader::skin_group, 1, 1}));
    const auto& push = module.structs.at("SkinPush").offsets;
    EXPECT_EQ(push.at("pose_y"), offsetof(shader::SkinPush, pose_y));
    EXPECT_EQ(push.at("box_low"), offsetof(shader::SkinPush, box_low));
    EXPECT_EQ(push.at("first_block"), offsetof(shader::SkinPush, first_block));
    EXPECT_EQ(push.at("pinhole"), offsetof(shader::SkinPush, pinhole));
    EXPECT_EQ(push.at("depth_range"), offsetof(shader::SkinPush, depth_range));
    EXPECT_EQ(push.at("width"), offsetof(shader::SkinPush, width));
    if (kernel == &spirv::skin_count_comp) {
      const auto& volume = module.structs.at("SkinVolume").offsets;
      EXPECT_EQ(volume.at("half_width"), offsetof(shader::SkinVolume, half_width));
      EXPECT_EQ(volume.at("kind"), offsetof(shader::SkinVolume, kind));
    }
    EXPECT_EQ(module.structs.at("SkinRun").offsets.at("before"), offsetof(shader::SkinRun, before));
  }
}

}  // namespace
}  // namespace palpa::sensing
