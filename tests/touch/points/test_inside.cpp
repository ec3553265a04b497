// Clusters of all skin inside a solid, the paper's other reading: --cluster inside.
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"
#include "touch/points/device_points.hpp"
#include "touch/points/regions.hpp"

namespace palpa::touch::test {
namespace {

FingerOptions inside(double gap_m = 5e-3, std::uint32_t least = 5) {
  return {.finger_gap_m = gap_m, .min_points = least, .cluster = Cluster::inside};
}

class Inside : public OnBothBackends {};
INSTANTIATE_TEST_SUITE_P(, Inside, ::testing::Values(Backend::cpu, Backend::gpu), backend_name);

/// Two fingertips that bend towards each other below the surface, as in a fist.
std::vector<glm::vec3> two_that_meet_below() {
  std::vector<glm::vec3> points;
  for (int i = 0; i < 400; ++i) {
    const float down = -0.02f * static_cast<float>(i) / 400, bend = 0.012f + 0.5f * down;
    for (const float side : {-1.0f, 1.0f}) {
      for (int k = 0; k < 8; ++k)
        points.emplace_back(side * bend + 2e-3f * static_cast<float>(k % 3), down, 1e-3f * static_cast<float>(k));
    }
  }
  return points;
}

TEST_P(Inside, FingersThatMeetBelowTheSurfaceAreOne) {
  const auto points = two_that_meet_below();
  FingerOptions contacts_alone = inside();
  contacts_alone.cluster = Cluster::contacts;
  EXPECT_EQ(touch_on(GetParam(), points, {cube()}, contacts_alone).finger_count, 2u);
  const Touch touch = touch_on(GetParam(), points, {cube()}, inside());
  EXPECT_GT(touch.deep.size(), touch.contacts.size());
  ASSERT_EQ(touch.finger_count, 1u);
  EXPECT_EQ(touch.fingers[0].contacts.size(), touch.contacts.size());
  EXPECT_EQ(touch.fingers[0].foci.size(), 10u);
  std::uint32_t sounding = 0;
  for (const Focus& focus : touch.fingers[0].foci)
    sounding += focus.points;
  EXPECT_EQ(sounding, touch.contacts.size());
}

TEST_P(Inside, IsWhatGrowingRegionsFinds) {
  unsigned seed = 30;
  for (const double gap : {1e-3, 2e-3, 3e-3}) {
    for (const std::uint32_t count : {1U, 2U, 500U, 3000U}) {
      const FingerOptions parameters = inside(gap, 2);
      const auto points = random_points(count, {-0.025, -0.03, -0.025}, {0.025, 0.005, 0.025}, ++seed);
      EXPECT_EQ(not_regions(touch_on(GetParam(), points, {cube()}, parameters), parameters), "");
    }
  }
}

TEST_P(Inside, DeepPointsAloneAreNoFinger) {
  const auto points = random_points(500, {-0.01, -0.03, -0.01}, {0.01, -0.01, 0.01});
  const Touch touch = touch_on(GetParam(), points, {cube()}, inside());
  EXPECT_EQ(touch.deep.size(), points.size());
  EXPECT_EQ(touch.finger_count, 0u);
  EXPECT_EQ(touch.cluster_count, 0u);
}

TEST(InsideOnDevice, IsTheTwinBitForBit) {
  const auto points = random_points(20'000, {-0.025, -0.045, -0.025}, {0.025, 0.005, 0.025}, 9);
  for (const double gap : {0.8e-3, 1.1e-3, 5e-3}) {
    const Touch twin = touch_on(Backend::cpu, points, {cube()}, inside(gap));
    const Touch touch = touch_on(Backend::gpu, points, {cube()}, inside(gap));
    EXPECT_GT(twin.deep.size(), twin.contacts.size());
    expect_identical(twin, touch);
    ASSERT_EQ(twin.deep.size(), touch.deep.size());
    EXPECT_EQ(std::memcmp(twin.deep.data(), touch.deep.data(), twin.deep.size() * sizeof(Contact)), 0);
  }
}

TEST(InsideOnDevice, SaysWhenThereIsNoRoom) {
  const auto points = indexed(random_points(1000, {-0.01, -0.03, -0.01}, {0.01, -0.01, 0.01}));
  DeviceStage stage({cube()}, {}, {.parameters = inside(), .most_contacts = 999});
  Touch touch;
  const Error error = palpa::test::thrown_by([&] { stage.touch(points, touch); });
  EXPECT_CONTAINS(error.what(), "1000 deep points in one frame: there is room for 999");
}

TEST(InsideOnDevice, AStageForItHasRoomForDeepPoints) {
  const PreparedSolids solids = prepare_solids({cube()}, inside());
  const sensing::RayTables no_rays = sensing::make_rays({});
  const Capacity capacity =
      DevicePoints(test_passes(), no_rays, solids, {.parameters = inside(), .most_points = 100, .most_contacts = 60})
          .capacity();
  EXPECT_EQ(capacity.contacts, 60u);
  EXPECT_EQ(capacity.deep, 60u);
  EXPECT_EQ(capacity.clustered(), 100u);
}

}  // namespace
}  // namespace palpa::touch::test
