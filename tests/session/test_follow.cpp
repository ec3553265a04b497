#include <gtest/gtest.h>

#include "session/follow.hpp"

namespace palpa::session {
namespace {

touch::Touch fingers_at(const std::vector<glm::vec3>& places, std::uint32_t solid = 0) {
  touch::Touch touch;
  touch.finger_count = static_cast<std::uint32_t>(places.size());
  touch.fingers.resize(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    touch.fingers[i].solid = solid;
    touch.fingers[i].section.centroid = places[i];
  }
  return touch;
}

std::vector<std::uint32_t> follow(Follower& follower, touch::Touch touch) {
  const auto ids = follower.follow(touch);
  return {ids.begin(), ids.end()};
}

TEST(Follower, KeepsIdsWhileTheOrderOfFingersChanges) {
  Follower follower;
  EXPECT_EQ(follow(follower, fingers_at({{0, 0, 0}, {0.05f, 0, 0}})), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(follow(follower, fingers_at({{0.051f, 0, 0}, {0.002f, 0, 0}})), (std::vector<std::uint32_t>{1, 0}));
}

TEST(Follower, GivesNewIdsAtBirthAndNeverAnOldOne) {
  Follower follower;
  follow(follower, fingers_at({{0, 0, 0}}));
  EXPECT_EQ(follow(follower, fingers_at({{0, 0, 0}, {0.03f, 0, 0}})), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(follow(follower, fingers_at({})).empty());
  EXPECT_EQ(follow(follower, fingers_at({{0, 0, 0}})), (std::vector<std::uint32_t>{2}));
}

TEST(Follower, TheClosestPairsComeFirst) {
  Follower follower;
  follow(follower, fingers_at({{0, 0, 0}, {0.015f, 0, 0}}));
  // Both moved right by 9 mm: the first new one is nearer to the second old one, and that one to its own successor.
  EXPECT_EQ(follow(follower, fingers_at({{0.009f, 0, 0}, {0.016f, 0, 0}})), (std::vector<std::uint32_t>{0, 1}));
}

TEST(Follower, NeverAcrossSolidsNorTooFar) {
  Follower follower;
  follow(follower, fingers_at({{0, 0, 0}}, 0));
  EXPECT_EQ(follow(follower, fingers_at({{0, 0, 0}}, 1)), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(follow(follower, fingers_at({{0.021f, 0, 0}}, 1)), (std::vector<std::uint32_t>{2}));
}

TEST(Follower, TakesAsManyFingersAsThereCanBe) {
  std::vector<glm::vec3> places;
  for (std::uint32_t i = 0; i < touch::max_fingers; ++i)
    places.emplace_back(0.05f * static_cast<float>(i), 0, 0);
  Follower follower;
  follow(follower, fingers_at(places));
  const auto ids = follow(follower, fingers_at(places));
  for (std::uint32_t i = 0; i < touch::max_fingers; ++i)
    EXPECT_EQ(ids[i], i);
}

}  // namespace
}  // namespace palpa::session
