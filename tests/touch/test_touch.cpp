// The whole touch computation: both backends against each other, and properties of every touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "support/device.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

TEST(WholeTouch, TheGpuAgreesWithTheTwinBitForBit) {
  auto points = fingertip(10'000, 3e-3, -0.012);
  const auto other = fingertip(10'000, 2e-3, 0.012, 0.003, 2);
  points.insert(points.end(), other.begin(), other.end());
  const std::vector<std::vector<geometry::Solid>> scenes{
      {cube()}, {half_ball({0, -0.02, 0}, 0.02, 1000)}, {ball({-0.01, -0.01, 0}, 0.0105, 80), cube()}};
  for (const auto& scene : scenes) {
    for (const FingerOptions& parameters :
         {FingerOptions{}, FingerOptions{.delta_m = 4e-3, .finger_gap_m = 0.5e-3, .foci = 7}}) {
      const Touch cpu = touch_on(Backend::cpu, points, scene, parameters);
      EXPECT_GT(cpu.contacts.size(), 30u);
      expect_identical(cpu, touch_on(Backend::gpu, points, scene, parameters));
    }
  }
  const auto cloud = random_points(30'000, Vec3(-0.05), Vec3(0.05));
  for (const double gap : {1.5e-3, 2.2e-3, 5e-3}) {
    const Touch cpu = touch_on(Backend::cpu, cloud, {everything()}, everything_is_contact(gap, 3));
    expect_identical(cpu, touch_on(Backend::gpu, cloud, {everything()}, everything_is_contact(gap, 3)));
  }
}

class WholeTouchOn : public OnBothBackends {};
INSTANTIATE_TEST_SUITE_P(, WholeTouchOn, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

TEST_P(WholeTouchOn, TwoFingersOnACubeAreTwoRings) {
  auto points = fingertip(10'000, 3e-3, -0.011);
  const auto other = fingertip(10'000, 3e-3, 0.011, 0, 2);
  points.insert(points.end(), other.begin(), other.end());
  const Touch touch = touch_on(GetParam(), points, {cube()});
  ASSERT_EQ(touch.finger_count, 2u);
  for (std::uint32_t f = 0; f < 2; ++f) {
    const Finger& finger = touch.fingers[f];
    EXPECT_NEAR(finger.section.centroid.x, f == 0 ? -0.011 : 0.011, 5e-4);
    EXPECT_GT(finger.section.axes[2].y, 0.99);
    ASSERT_EQ(finger.foci.size(), 10u);
    for (const Focus& focus : finger.foci) {
      // The skin of a fingertip of 8 mm radius, 1.5 to 3 mm above its tip: 4.7 to 6.2 mm from its axis.
      const float dx = focus.position.x - finger.section.centroid.x, dz = focus.position.z - finger.section.centroid.z;
      EXPECT_NEAR(std::hypot(dx, dz), 5.5e-3, 0.9e-3);
      EXPECT_GT(focus.points, 5u);
    }
  }
}

TEST(TouchOnDevice, KeepsThePointsIndices) {
  std::vector<sensing::SkinPoint> skin;
  const auto points = fingertip(3000, 3e-3);
  for (std::uint32_t i = 0; i < points.size(); ++i)
    skin.push_back({points[i], 1'200'000 + 7 * i});
  const Touch gpu = touch_on_device(skin, {cube()}, {});
  Touch cpu;
  Stage({cube()}).touch(skin, cpu);
  ASSERT_GT(gpu.contacts.size(), 20u);
  EXPECT_EQ(gpu.contacts.front().point % 7, 1'200'000u % 7);
  expect_identical(cpu, gpu);
}

TEST(TouchOnDevice, GivesTheSameBytesOnEveryRun) {
  // Clouds whose clusters are long and tangled, so that threads meet in the union-find; touch_on_device compares the
  // runs.
  const auto flat = indexed(random_points(3000, {-0.05, 0.01, -0.05}, {0.05, 0.01, 0.05}));
  touch_on_device(flat, {everything()}, {.parameters = everything_is_contact(2e-3)}, 150);
  const auto cloud = indexed(random_points(6000, Vec3(0), Vec3(0.1)));
  touch_on_device(cloud, {everything()}, {.parameters = everything_is_contact(4.8e-3)}, 60);
}

TEST(TouchOnDevice, SaysWhenThereIsNoRoom) {
  const auto points = indexed(random_points(1000, Vec3(-0.1), Vec3(0.1)));
  const auto said = [&](std::uint32_t most_points, std::uint32_t most_contacts) {
    const StageSetting setting{
        .parameters = everything_is_contact(), .most_points = most_points, .most_contacts = most_contacts};
    return std::string(palpa::test::thrown_by([&] { touch_on_device(points, {everything()}, setting); }).what());
  };
  EXPECT_EQ(said(1000, 1000), "");
  EXPECT_EQ(said(0, 0), "");
  EXPECT_CONTAINS(said(1000, 999), "1000 contacts in one frame: there is room for 999");
  EXPECT_CONTAINS(said(999, 999), "1000 skin points in one frame: there is room for 999");
  EXPECT_CONTAINS(said(5'000'000, 10), "at most");
}

TEST(TouchOnDevice, TakesTheRoomThatPointsNeedAndKeepsIt) {
  const gpu::Device& device = palpa::test::test_device();
  DeviceStage stage({everything()}, {}, {.parameters = everything_is_contact()});
  Stage twin({everything()}, {}, {.parameters = everything_is_contact()});
  std::uint64_t allocations = 0;
  for (const std::uint32_t count : {10U, 5000U, 4999U, 0U, 20'000U}) {
    const auto points = indexed(random_points(count, Vec3(-0.1), Vec3(0.1), count));
    Touch found, expected;
    stage.touch(points, found);
    twin.touch(points, expected);
    ASSERT_EQ(found.contacts.size(), count);
    expect_identical(expected, found);
    if (count == 4999 || count == 0) {
      EXPECT_EQ(device.memory_allocations, allocations) << count;
    }
    allocations = device.memory_allocations;
  }
}

TEST(Passes, MakeThePipelinesThatStagesNeedAndEachOnce) {
  const gpu::Device device;
  Passes passes(device);
  std::uint64_t before = device.pipelines_created;
  const auto made = [&](const std::vector<geometry::Solid>& solids, const StageSetting& setting) {
    const Stage stage(passes, solids, {}, setting);
    const std::uint64_t now = device.pipelines_created, count = now - before;
    before = now;
    return count;
  };
  EXPECT_EQ(made({cube()}, {}), 13u);                             // to find and pack contacts; for fingers
  EXPECT_EQ(made({cube(), cube()}, {}), 1u);                      // to find contacts of several solids
  EXPECT_EQ(made({cube()}, {.parameters = {.deep = true}}), 1u);  // to find deep points of one
  EXPECT_EQ(made({cube()}, {.parameters = {.cluster = Cluster::inside}}), 2u);  // to cluster them
  EXPECT_EQ(made({cube()}, {.follow = true}), 0u);
}

}  // namespace
}  // namespace palpa::touch::test
