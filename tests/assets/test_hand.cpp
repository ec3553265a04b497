#include <map>
#include <numbers>
#include <string>
#include <string_view>

#include "assets/generators/hand.hpp"
#include "assets/generators/shape.hpp"
#include "crossings.hpp"
#include "shape_checks.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

const HandPose& pose(std::string_view name) {
  static std::map<std::string, HandPose> poses;
  return poses.try_emplace(std::string(name), *named_hand_pose(name)).first->second;
}

/// Each pose's hand is made once.
const Mesh& hand(std::string_view name) {
  static std::map<std::string, Mesh> hands;
  Mesh& mesh = hands[std::string(name)];
  if (mesh.positions.empty()) mesh = make_hand(pose(name));
  return mesh;
}

void expect_skin(const Mesh& mesh) {
  expect_sphere_like(mesh);
  EXPECT_EQ(count_crossings(mesh, 5e-3), 0U);
  EXPECT_GT(smallest_angle(mesh), 15 * std::numbers::pi / 180);
  EXPECT_GE(mesh.triangles.size(), 15000U);
  EXPECT_LE(mesh.triangles.size(), 25000U);
}

TEST(Crossings, AreFoundWhereASurfaceRunsThroughItself) {
  const Mesh through{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -0.5}, {0.3, 0.2, 0.5}, {0.2, 0.3, 0.5}},
                     {{0, 1, 2}, {3, 4, 5}}};
  EXPECT_EQ(count_crossings(through, 2), 2U);
  Mesh apart = through;
  for (int i = 3; i < 6; ++i)
    apart.positions[i].z += 0.6;
  EXPECT_EQ(count_crossings(apart, 2), 0U);
}

class EveryPose : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryPose, HasOneSkinThatDoesNotCrossItself) {
  expect_skin(hand(GetParam()));
}

TEST_P(EveryPose, EndsInRoundFingertips) {
  const Mesh& mesh = hand(GetParam());
  const auto tips = fingertips(pose(GetParam()));
  // In the pose `point`, the other fingers press against the palm, which flattens them.
  const std::size_t free = GetParam() == std::string("point") ? 2 : tips.size();
  for (std::size_t i = 0; i < free; ++i) {
    const Fingertip& tip = tips[i];
    EXPECT_GE(tip.radius, 7e-3);
    EXPECT_LE(tip.radius, 9e-3);
    EXPECT_NEAR(glm::length(tip.direction), 1.0, 1e-12);
    const Vec3 centre = tip.position - tip.direction * tip.radius;
    int near = 0;
    for (const Vec3& p : mesh.positions) {
      if (glm::distance(p, tip.position) > 3e-3) continue;
      EXPECT_NEAR(glm::distance(p, centre), tip.radius, 0.05e-3);
      ++near;
    }
    EXPECT_GE(near, 12);
    EXPECT_NEAR(mean_edge(mesh, [&](const Vec3& p) { return glm::distance(p, tip.position) < 5e-3; }), 1.2e-3, 0.15e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Hand, EveryPose,
                         ::testing::ValuesIn(test::the_first<const char*>(1, {"spread", "point", "relaxed"})),
                         [](const auto& name) { return std::string(name.param); });

TEST(Hand, IsLifeSize) {
  // From the wrist's crease, 176 mm above the straight index finger's tip, to the middle finger's.
  const double middle = fingertips({})[2].position.y;
  EXPECT_GE(0.176 - middle, 0.18);
  EXPECT_LE(0.176 - middle, 0.19);
  EXPECT_GT(geometry::signed_volume(hand("spread")), 350e-6);
  EXPECT_LT(geometry::signed_volume(hand("spread")), 450e-6);
}

TEST(Hand, PointsAtTheOrigin) {
  const Fingertip index = fingertips(pose("point"))[1];
  EXPECT_NEAR(glm::length(index.position), 0.0, 1e-12);
  EXPECT_NEAR(glm::distance(index.direction, Vec3(0, -1, 0)), 0.0, 1e-12);
  // The skin's lowest vertex is beside the origin, at most a chord's depth above it. The finger runs up the y axis.
  Vec3 lowest(1.0);
  for (const Vec3& p : hand("point").positions) {
    if (p.y < lowest.y) lowest = p;
    if (p.y < 0.02) {
      EXPECT_LT(std::hypot(p.x, p.z), 9.5e-3);
    }
  }
  EXPECT_GT(lowest.y, -1e-5);
  EXPECT_LT(lowest.y, 6e-5);
  EXPECT_LT(std::hypot(lowest.x, lowest.z), 1e-3);
}

TEST(Hand, IsARightHandWithItsPalmTowardsMinusZ) {
  const auto tips = fingertips(pose("spread"));
  for (int i = 0; i + 1 < 5; ++i)
    EXPECT_GT(tips[i].position.x, tips[i + 1].position.x + 5e-3);  // thumb on the +x side
  // Flexion moves fingertips towards -z; more flexion moves them farther back up.
  const auto bent = fingertips(pose("relaxed")), fist = fingertips(pose("fist"));
  for (int i = 1; i < 5; ++i) {
    EXPECT_LT(bent[i].position.z, tips[i].position.z - 0.03);
    EXPECT_GT(fist[i].position.y, bent[i].position.y + 0.02);
  }
}

TEST(Hand, KeepsPressedFingersApart) {
  expect_skin(hand("fist"));
}

TEST(Hand, StaysWholeInBetweenPoses) {
  if (test::instrumented()) GTEST_SKIP() << "skipped: one more hand is made the same way";
  // Halfway from spread to fist, as in an animation.
  HandPose between = pose("spread");
  const HandPose& fist = pose("fist");
  const auto mix = [](double& a, double b) { a = 0.5 * (a + b); };
  mix(between.thumb.cmc, fist.thumb.cmc);
  mix(between.thumb.mcp, fist.thumb.mcp);
  mix(between.thumb.ip, fist.thumb.ip);
  for (int i = 0; i < 4; ++i) {
    mix(between.fingers[i].mcp, fist.fingers[i].mcp);
    mix(between.fingers[i].pip, fist.fingers[i].pip);
    mix(between.fingers[i].dip, fist.fingers[i].dip);
    mix(between.fingers[i].abduction, fist.fingers[i].abduction);
  }
  expect_skin(make_hand(between));
}

}  // namespace
}  // namespace palpa::assets
