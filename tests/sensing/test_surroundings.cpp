#include "sensing/surroundings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "skin_run.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

using test_skin::random_scene;
using test_skin::run_pass;
using test_skin::run_twin;
using test_skin::same_bytes;
using test_skin::Scene;

/// Boards and a screen in random places where the random cameras look, and a room in half of the cases.
Surroundings random_surroundings(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Surroundings all;
  for (std::uint32_t i = test::uniform(random, 0, 5); i > 0; --i) {
    all.slabs.push_back({i == 1 ? NoSkin::screen : NoSkin::board, 0.05 + 0.4 * unit(random), 0.05 + 0.4 * unit(random),
                         test::random_pose(random, 0.3)});
  }
  if (test::uniform(random, 0, 1) == 0) {
    all.room.emplace();
    all.room->add(Vec3(-0.1 - unit(random), -0.1 - unit(random), -0.1 - unit(random)));
    all.room->add(Vec3(0.1 + unit(random), 0.1 + unit(random), 0.1 + unit(random)));
  }
  return all;
}

/// A background for a random part of the pixels, about as far as what the frame shows.
void learn_some(std::mt19937_64& random, Camera& camera, const DepthFrame& frame) {
  Background background{"background.png", std::vector<std::uint16_t>(pixel_count(camera)), 0.004};
  for (std::size_t i = 0; i < background.depth.size(); ++i) {
    const std::uint32_t kind = test::uniform(random, 0, 3);
    const double factor = kind == 0 ? 0 : kind == 1 ? 0.5 : kind == 2 ? 1.005 : 1.02;
    background.depth[i] = static_cast<std::uint16_t>(std::min(65535.0, frame.depth[i] * factor));
  }
  camera.background = std::make_shared<Background>(std::move(background));
}

/// How far inside the slab the point lies, in double precision; negative outside.
double inside_by(const Slab& slab, const Vec3& world) {
  const Vec3 p = transform_point(glm::inverse(slab.T_world_slab), world);
  return std::min({slab.width_m / 2 - std::abs(p.x), slab.height_m / 2 - std::abs(p.y), p.z + 0.05, 0.008 - p.z});
}
double inside_by(const Box& box, const Vec3& p) {
  double least = 1e300;
  for (int i = 0; i < 3; ++i)
    least = std::min({least, p[i] - box.low[i], box.high[i] - p[i]});
  return least;
}

TEST(Surroundings, DropWhatBruteForceInDoubleFindsAndNothingElse) {
  std::mt19937_64 random(41);
  std::size_t kept = 0;
  Dropped dropped;
  for (int round = 0; round < 60; ++round) {
    Scene scene = random_scene(random, test::uniform(random, 1, 3));
    Box box = test::random_box(random);
    if (round % 3 == 0) box = {Vec3(-1), Vec3(1)};
    const Surroundings surroundings = random_surroundings(random);
    const auto all = find_skin(scene.cameras, scene.frames, box);
    const SkinOfFrame found = run_twin(scene, box, {.surroundings = surroundings});
    ASSERT_EQ(all.size(), found.points.size() + found.leavings.size());
    ASSERT_EQ(found.dropped.total(), found.leavings.size());
    dropped += found.dropped;
    kept += found.points.size();

    constexpr double band = 3e-6;
    std::set<std::uint32_t> gone;
    for (const SkinPoint& point : found.leavings)
      gone.insert(point.index);
    for (const SkinPoint& point : all) {
      double deepest = surroundings.room ? -inside_by(*surroundings.room, Vec3(point.position)) : -1;
      for (const Slab& slab : surroundings.slabs)
        deepest = std::max(deepest, inside_by(slab, Vec3(point.position)));
      if (gone.contains(point.index)) {
        ASSERT_GE(deepest, -band) << "round " << round << ", point " << point.index;
      } else {
        ASSERT_LE(deepest, band) << "round " << round << ", point " << point.index;
      }
    }
  }
  EXPECT_GT(kept, 4000U);
  for (const NoSkin why : {NoSkin::room, NoSkin::board, NoSkin::screen})
    EXPECT_GT(dropped[why], 200U) << static_cast<int>(why);
  EXPECT_EQ(dropped[NoSkin::background], 0U);
}

TEST(Surroundings, DeviceGivesTheTwinsBytesAndCounts) {
  std::mt19937_64 random(43);
  Dropped dropped;
  for (int round = 0; round < 20; ++round) {
    Scene scene = random_scene(random, test::uniform(random, 1, 3));
    Box box = test::random_box(random);
    if (round % 2 == 0) box = {Vec3(-1), Vec3(1)};
    const Surroundings surroundings = random_surroundings(random);
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
      if (test::uniform(random, 0, 1) == 0) learn_some(random, scene.cameras[c], scene.frames[c]);
    }
    const std::uint32_t stride = round % 5 == 0 ? 3 : 1;
    const test_skin::RunSetting setting{.stride = stride, .surroundings = surroundings};
    const SkinOfFrame twin = run_twin(scene, box, setting);
    const auto device = run_pass(scene, box, setting);
    EXPECT_TRUE(same_bytes(twin.points, device.points)) << round << ": " << twin.points.size();
    EXPECT_EQ(twin.dropped, device.dropped) << "round " << round;
    dropped += device.dropped;
  }
  for (const std::uint64_t count : dropped.counts)
    EXPECT_GT(count, 40U);
}

TEST(Surroundings, ABackgroundDropsWhatIsNotNearerByItsMargin) {
  Camera camera = test::d415(Transform(1.0));
  camera.min_range_m = 0;
  Background background{"b.png", std::vector<std::uint16_t>(pixel_count(camera), 5000), 0.005};
  background.depth[7] = 0;       // unknown
  background.depth[8] = 20'000;  // at 2 m, the margin is four times as large
  background.depth[9] = 20;      // nearer than the margin
  camera.background = std::make_shared<Background>(std::move(background));
  EXPECT_EQ(nearer_than_background(camera, 6), 4949);
  EXPECT_EQ(nearer_than_background(camera, 7), 65535);
  EXPECT_EQ(nearer_than_background(camera, 8), 19'799);
  EXPECT_EQ(nearer_than_background(camera, 9), 0);

  Scene scene{{camera}, {{std::vector<std::uint16_t>(pixel_count(camera), 4949), 0}}};
  DepthFrame& frame = scene.frames[0];
  frame.depth[5] = 4950;
  frame.depth[6] = 9000;
  frame.depth[7] = 60'000;
  frame.depth[8] = 19'800;
  const Box everything{Vec3(-100), Vec3(100)};
  const SkinOfFrame found = run_twin(scene, everything);
  ASSERT_EQ(found.leavings.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(found.leavings[i].index, (std::array<std::uint32_t, 4>{5, 6, 8, 9})[i]);
  EXPECT_EQ(found.dropped[NoSkin::background], 4U);
  EXPECT_EQ(count_valid(scene.cameras, scene.frames), found.points.size());
  EXPECT_TRUE(same_bytes(found.points, run_pass(scene, everything).points));

  Camera other = camera;
  other.width = 640;
  EXPECT_ERROR(make_rays(std::span(&other, 1)), Exit::usage, "its background has 407040 pixels");
}

TEST(Surroundings, AreLeftOutWhereTheyCannotMatter) {
  const Transform wall = glm::translate(Transform(1.0), Vec3(0, 0, -0.2));
  const Surroundings surroundings{{{NoSkin::board, 0.2, 0.1, wall}}, Box{Vec3(-1), Vec3(1)}};
  const auto volumes_for = [&](const Vec3& low, const Vec3& high) {
    std::vector<shader::SkinVolume> volumes;
    plan_drops(surroundings, {low, high}, volumes);
    return volumes.size();
  };
  EXPECT_EQ(most_drops(surroundings), 2U);
  EXPECT_EQ(volumes_for(Vec3(-0.1), Vec3(0.1)), 0U);                           // inside the room, before the board
  EXPECT_EQ(volumes_for(Vec3(-0.1, -0.1, -0.191), Vec3(0.1)), 0U);             // 9 mm before it
  EXPECT_EQ(volumes_for(Vec3(-0.1, -0.1, -0.193), Vec3(0.1)), 1U);             // 7 mm before it
  EXPECT_EQ(volumes_for(Vec3(0.101, -0.1, -0.3), Vec3(0.2)), 0U);              // beside it
  EXPECT_EQ(volumes_for(Vec3(-0.1, -0.1, -0.4), Vec3(0.1, 0.1, -0.251)), 0U);  // behind it
  EXPECT_EQ(volumes_for(Vec3(-2, -2, -2), Vec3(2)), 2U);
  std::vector<shader::SkinVolume> none(3);
  plan_drops(surroundings, Box{}, none);
  EXPECT_TRUE(none.empty());
}

TEST(Surroundings, AMeshReachesIntoASlabIfASurfaceDoes) {
  const Transform tilted = glm::rotate(glm::translate(Transform(1.0), Vec3(0.1, 0.2, 0.3)), 0.7, Vec3(1, 2, 3));
  const Slab slab{NoSkin::board, 0.2, 0.1, tilted};
  const auto cube_at = [&](const Vec3& at, double half) {  // in the slab's frame
    return test::transformed(test::box(Vec3(-half), Vec3(half)),
                             [&](const Vec3& p) { return transform_point(tilted, p + at); });
  };
  EXPECT_TRUE(reaches_into(cube_at(Vec3(0, 0, 0.017), 0.01), slab));
  EXPECT_FALSE(reaches_into(cube_at(Vec3(0, 0, 0.019), 0.01), slab));
  EXPECT_TRUE(reaches_into(cube_at(Vec3(0, 0, -0.059), 0.01), slab));
  EXPECT_FALSE(reaches_into(cube_at(Vec3(0, 0, -0.061), 0.01), slab));
  EXPECT_TRUE(reaches_into(cube_at(Vec3(0.109, 0, 0), 0.01), slab));
  EXPECT_FALSE(reaches_into(cube_at(Vec3(0.111, 0, 0), 0.01), slab));
  EXPECT_FALSE(reaches_into(cube_at(Vec3(0.109, 0.059, 0.017), 0.001), slab));
  EXPECT_TRUE(reaches_into(cube_at(Vec3(0.3, 0, 0), 0.25), slab));  // a large face cuts through, no corner is inside
}

}  // namespace
}  // namespace palpa::sensing
