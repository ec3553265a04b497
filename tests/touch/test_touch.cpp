// The whole touch computation: both backends against each other, and properties of every touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/error.hpp"
#include "gpu/commands.hpp"
#include "support/device.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

const Transform tilt(0.36, 0.48, -0.8, 0, -0.8, 0.6, 0, 0, 0.48, 0.64, 0.6, 0, 0.1, -0.2, 0.15, 1);

TEST(WholeTouch, TheGpuAgreesWithTheTwinBitForBit) {
  auto points = fingertip(10'000, 3e-3, -0.012);
  const auto other = fingertip(10'000, 2e-3, 0.012, 0.003, 2);
  points.insert(points.end(), other.begin(), other.end());
  const std::vector<std::vector<geometry::Solid>> scenes{
      {cube()}, {half_ball({0, -0.02, 0}, 0.02, 1000)}, {ball({-0.01, -0.01, 0}, 0.0105, 80), cube()}};
  for (const auto& scene : scenes) {
    for (const Parameters& parameters :
         {Parameters{}, Parameters{.delta_m = 4e-3, .finger_gap_m = 0.5e-3, .foci = 7}}) {
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

TEST_P(WholeTouchOn, APermutationOfPointsPermutesIndices) {
  const auto points = fingertip(8000, 3e-3);
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  std::vector<glm::vec3> shuffled;
  shuffled.reserve(points.size());
  for (const std::uint32_t i : order)
    shuffled.push_back(points[i]);
  const Touch a = touch_on(GetParam(), points, {cube()}), b = touch_on(GetParam(), shuffled, {cube()});
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  std::vector<std::uint32_t> of_a, of_b;
  of_a.reserve(a.contacts.size());
  of_b.reserve(b.contacts.size());
  for (const Contact& contact : a.contacts)
    of_a.push_back(contact.point);
  for (const Contact& contact : b.contacts)
    of_b.push_back(order[contact.point]);
  std::sort(of_b.begin(), of_b.end());
  EXPECT_EQ(of_a, of_b);
  ASSERT_EQ(b.finger_count, a.finger_count);
  for (std::size_t n = 0; n < a.fingers[0].foci.size(); ++n) {
    EXPECT_EQ(a.fingers[0].foci[n].points, b.fingers[0].foci[n].points);
    EXPECT_LE(glm::length(a.fingers[0].foci[n].position - b.fingers[0].foci[n].position), 1e-7F);
  }
}

/// As unordered sets of foci: a turned frame may begin its sectors elsewhere.
void expect_foci_moved(const Touch& from, const Touch& to, const Transform& motion, double scale) {
  ASSERT_EQ(from.contacts.size(), to.contacts.size());
  ASSERT_EQ(from.finger_count, to.finger_count);
  for (std::uint32_t f = 0; f < from.finger_count; ++f) {
    const Finger &a = from.fingers[f], &b = to.fingers[f];
    ASSERT_EQ(a.contacts, b.contacts);
    const Vec3 centroid = transform_point(motion, Vec3(a.section.centroid) * scale);
    EXPECT_LE(glm::length(centroid - Vec3(b.section.centroid)), 2e-7 * scale);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(b.section.eigenvalues[k], a.section.eigenvalues[k] * scale * scale, 1e-5 * b.section.eigenvalues[0]);
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = transform_direction(motion, Vec3(a.section.axes[k]));
      EXPECT_GE(std::abs(glm::dot(axis, Vec3(b.section.axes[k]))), 1 - 1e-5);
    }
  }
}

TEST_P(WholeTouchOn, MotionAndScaleCarryEverythingAlong) {
  // An oval touch, so that the axes are distinct.
  std::vector<glm::vec3> points;
  for (glm::vec3 p : fingertip(12'000, 3e-3))
    points.emplace_back(p.x * 1.6F, p.y, p.z);
  const Touch still = touch_on(GetParam(), points, {cube()});
  ASSERT_EQ(still.finger_count, 1u);
  for (const double scale : {1.0, 3.0}) {
    std::vector<glm::vec3> moved_points;
    moved_points.reserve(points.size());
    for (const glm::vec3& p : points)
      moved_points.emplace_back(transform_point(tilt, Vec3(p) * scale));
    // Points within rounding of a boundary may change sides: keep to those that do not.
    Parameters parameters;
    parameters.delta_m *= scale;
    parameters.finger_gap_m *= scale;
    const geometry::Solid solid = moved(cube(), tilt, scale);
    const Touch there = touch_on(GetParam(), moved_points, {solid}, parameters);
    std::vector<glm::vec3> kept, kept_moved;
    std::vector<bool> in_both(points.size(), false), in_one(points.size(), false);
    for (const Contact& contact : still.contacts)
      in_one[contact.point] = true;
    for (const Contact& contact : there.contacts)
      in_both[contact.point] = in_one[contact.point];
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!in_both[i]) continue;
      kept.push_back(points[i]);
      kept_moved.push_back(moved_points[i]);
    }
    EXPECT_GE(kept.size() + 2, still.contacts.size());
    expect_foci_moved(touch_on(GetParam(), kept, {cube()}), touch_on(GetParam(), kept_moved, {solid}, parameters), tilt,
                      scale);
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

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
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
    return message_of([&] {
      touch_on_device(
          points, {everything()},
          {.parameters = everything_is_contact(), .most_points = most_points, .most_contacts = most_contacts});
    });
  };
  EXPECT_EQ(said(1000, 1000), "");
  EXPECT_EQ(said(0, 0), "");
  EXPECT_NE(said(1000, 999).find("1000 contacts in one frame: there is room for 999"), std::string::npos);
  EXPECT_NE(said(999, 999).find("1000 skin points in one frame: there is room for 999"), std::string::npos);
  EXPECT_NE(said(5'000'000, 10).find("at most"), std::string::npos);
}

TEST(TouchOnDevice, TakesTheRoomThatPointsNeed) {
  DeviceStage stage({everything()}, {}, {.parameters = everything_is_contact()});
  Stage twin({everything()}, {}, {.parameters = everything_is_contact()});
  for (const std::uint32_t count : {10U, 5000U, 4999U, 0U, 20'000U}) {
    const auto points = indexed(random_points(count, Vec3(-0.1), Vec3(0.1), count));
    Touch found, expected;
    stage.touch(points, found);
    twin.touch(points, expected);
    ASSERT_EQ(found.contacts.size(), count);
    expect_identical(expected, found);
  }
}

TEST(TouchOnDevice, AllocatesNothingAfterTheFirstFrame) {
  const gpu::Device device;
  Passes passes(device);
  Stage stage(passes, {cube()});
  const auto points = indexed(fingertip(10'000, 3e-3));
  Touch out;
  std::uint64_t allocations = 0, pipelines = 0;
  const void *contacts = nullptr, *foci = nullptr;
  for (int frame = 0; frame < 5; ++frame) {
    stage.touch(std::span(points).first(points.size() - 1000 * static_cast<std::size_t>(frame)), out);
    ASSERT_EQ(out.finger_count, 1u);
    if (frame == 0) {
      allocations = device.memory_allocations;
      pipelines = device.pipelines_created;
      contacts = out.contacts.data();
      foci = out.fingers[0].foci.data();
    }
  }
  EXPECT_EQ(device.memory_allocations, allocations);
  EXPECT_EQ(device.pipelines_created, pipelines);
  EXPECT_EQ(out.contacts.data(), contacts);
  EXPECT_EQ(out.fingers[0].foci.data(), foci);
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
