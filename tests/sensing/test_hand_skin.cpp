// The skin points of tracked hands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include "sensing/joints/capsules.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::sensing {
namespace {

const Box everywhere{Vec3(-10), Vec3(10)};

Capsule random_capsule(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-0.03, 0.03), radius(0.004, 0.012);
  return {{place(random), place(random), place(random)},
          {place(random), place(random), place(random)},
          radius(random),
          radius(random)};
}

/// The least distance from any of the balls that make up the hull.
double distance_by_balls(const Capsule& c, const Vec3& p) {
  double least = 1e9;
  for (int i = 0; i <= 2000; ++i) {
    const double part = i / 2000.0;
    const double radius_m = c.radius_a_m + part * (c.radius_b_m - c.radius_a_m);
    least = std::min(least, glm::distance(p, c.a + part * (c.b - c.a)) - radius_m);
  }
  return least;
}

TEST(HandSkin, TheDistanceFromACapsuleIsThatFromItsBalls) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-0.05, 0.05);
  for (int i = 0; i < 200; ++i) {
    Capsule capsule = random_capsule(random);
    if (i % 10 == 0) capsule.b = capsule.a;                     // a ball
    if (i % 10 == 1) capsule.b = capsule.a + Vec3(0, 1e-5, 0);  // one ball within the other
    if (i % 10 == 2) capsule.radius_b_m = capsule.radius_a_m;   // a cylinder
    const Vec3 point(place(random), place(random), place(random));
    EXPECT_NEAR(distance_to(capsule, point), distance_by_balls(capsule, point), 1e-6) << i;
  }
}

/// The area of the hull of two balls, neither of which is within the other: two caps, and the cone between them.
double area_of(const Capsule& c) {
  const double length = glm::distance(c.a, c.b), lean = (c.radius_a_m - c.radius_b_m) / length;
  const double along = std::sqrt(1 - lean * lean);
  const double caps = 2 * c.radius_a_m * c.radius_a_m * (1 + lean) + 2 * c.radius_b_m * c.radius_b_m * (1 - lean);
  return std::numbers::pi * (along * (c.radius_a_m + c.radius_b_m) * length * along + caps);
}

TEST(HandSkin, PointsLieEvenlyOnACapsule) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 5; ++i) {
    Capsule capsule = random_capsule(random);
    if (glm::distance(capsule.a, capsule.b) < 0.02) capsule.b = capsule.a + Vec3(0.03, 0.01, 0);
    std::vector<SkinPoint> points;
    ASSERT_TRUE(sample_skin(std::span(&capsule, 1), everywhere, points));
    EXPECT_NEAR(static_cast<double>(points.size()) * skin_pitch_m * skin_pitch_m / area_of(capsule), 1, 0.04);
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_EQ(points[k].index, k);
      EXPECT_LT(std::abs(distance_by_balls(capsule, Vec3(points[k].position))), 1e-6);
      if (k % 20 != 0) continue;
      float nearest = 1;
      for (std::size_t other = 0; other < points.size(); ++other) {
        if (other != k) nearest = std::min(nearest, glm::distance(points[k].position, points[other].position));
      }
      EXPECT_GT(nearest, 0.4 * skin_pitch_m);
      EXPECT_LT(nearest, 1.1 * skin_pitch_m);
    }
  }
}

TEST(HandSkin, OfAHandIsWhatCanBeTouched) {
  std::vector<Capsule> bones;
  append_capsules(test::pointing_hand({0, 0, 0}), Transform(1.0), bones);
  ASSERT_EQ(bones.size(), 19U);
  std::vector<SkinPoint> all, near, again;
  ASSERT_TRUE(sample_skin(bones, everywhere, all));
  for (const SkinPoint& point : all) {
    double least = 1;
    for (const Capsule& bone : bones)
      least = std::min(least, distance_to(bone, Vec3(point.position)));
    ASSERT_LT(std::abs(least), 1e-6) << "on the surface of all of them, in none";
  }
  // A box has the points that lie in it, in the same order, and nothing else matters for them.
  const Box tip{Vec3(-0.02, -0.01, -0.02), Vec3(0.02, 0.01, 0.02)};
  ASSERT_TRUE(sample_skin(bones, tip, near));
  std::vector<glm::vec3> expected, places;
  for (const SkinPoint& point : all) {
    const Vec3 p(point.position);
    if (glm::all(glm::greaterThanEqual(p, tip.low)) && glm::all(glm::lessThanEqual(p, tip.high)))
      expected.push_back(point.position);
  }
  for (const SkinPoint& point : near)
    places.push_back(point.position);
  EXPECT_EQ(places, expected);
  EXPECT_GT(places.size(), 200U);
  ASSERT_TRUE(sample_skin(bones, tip, again));
  EXPECT_TRUE(std::ranges::equal(near, again, {}, &SkinPoint::position, &SkinPoint::position));
}

TEST(HandSkin, HasAnEnd) {
  std::vector<Capsule> bones(40, {{0, 0, 0}, {0.1, 0, 0}, 0.03, 0.03});
  for (std::size_t i = 0; i < bones.size(); ++i) {
    bones[i].a.z += static_cast<double>(i);
    bones[i].b.z += static_cast<double>(i);
  }
  std::vector<SkinPoint> points;
  EXPECT_FALSE(sample_skin(bones, {Vec3(-100), Vec3(100)}, points));
  EXPECT_TRUE(points.empty());
  EXPECT_TRUE(sample_skin({}, everywhere, points));
}

TEST(HandSkin, MovesWithTheTracker) {
  Transform T_world_joints(1.0);
  T_world_joints[3] = Vec4(0.1, 0.2, 0.3, 1);
  std::vector<Capsule> here, there;
  append_capsules(test::pointing_hand({0, 0, 0}), Transform(1.0), here);
  append_capsules(test::pointing_hand({0, 0, 0}), T_world_joints, there);
  for (std::size_t i = 0; i < here.size(); ++i)
    EXPECT_LT(glm::distance(here[i].b + Vec3(0.1, 0.2, 0.3), there[i].b), 1e-12);
}

}  // namespace
}  // namespace palpa::sensing
