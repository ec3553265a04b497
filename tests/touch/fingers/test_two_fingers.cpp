// Two fingers that cross, merge and part, as one and three D415 see them: are they still identified correctly at the
// end?
#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "support/exhaustive.hpp"
#include "touch/fingers/two_fingers.hpp"

namespace palpa::touch::test {
namespace {

/// What became of a walk.
struct Story {
  std::array<std::optional<std::uint32_t>, 2> before, after;  ///< each finger's id, alone, before and after they met
  std::set<std::uint32_t> ids;
  std::size_t merged = 0;  ///< frames with one cluster of both
};

Story story_of(const std::vector<Sighting>& sightings) {
  Story story;
  for (const Sighting& s : sightings) {
    story.ids.insert(s.id);
    story.merged += s.both() ? 1 : 0;
  }
  for (const Sighting& s : sightings) {
    if (s.both()) break;
    for (int k = 0; k < 2; ++k) {
      if (s.skin[k]) story.before[k] = s.id;
    }
  }
  for (const Sighting& s : sightings) {
    for (int k = 0; k < 2; ++k) {
      if (s.skin[k]) story.after[k] = s.both() ? std::nullopt : std::optional(s.id);
    }
  }
  return story;
}

void expect_sensible(const Walk& walk, int cameras, double rate_hz) {
  const Story story = story_of(follow(walk, film(walk, cameras, rate_hz, 7), cameras));
  ASSERT_TRUE(story.before[0] && story.before[1]);
  EXPECT_NE(story.before[0], story.before[1]);
  EXPECT_EQ(story.after[0], story.before[0]);
  EXPECT_EQ(story.after[1], story.before[1]);
  EXPECT_EQ(story.ids.size(), 2u);
  EXPECT_GT(story.merged, 0u);
}

using Setting = std::tuple<int, double, double>;  ///< cameras, frames per second, speed of each finger

std::string setting_name(const ::testing::TestParamInfo<Setting>& given) {
  const auto& [cameras, rate_hz, speed] = given.param;
  return std::to_string(cameras) + "Cameras" + std::to_string(static_cast<int>(rate_hz)) + "Hz" +
         std::to_string(static_cast<int>(1e3 * speed)) + "mmps";
}

/// The slowest fingers are tested only if exhaustive(): they take as many frames as all others together.
std::vector<Setting> settings() {
  std::vector<Setting> all{{3, 90, 0.2}, {3, 90, 0.5}, {1, 90, 0.1}, {1, 90, 0.4}, {1, 15, 0.05}, {3, 15, 0.08}};
  if (palpa::test::exhaustive()) all.emplace_back(3, 90, 0.05);
  return all;
}

class TwoFingers : public ::testing::TestWithParam<Setting> {};
INSTANTIATE_TEST_SUITE_P(, TwoFingers, ::testing::ValuesIn(settings()), setting_name);

TEST_P(TwoFingers, CrossOver) {
  const auto [cameras, rate_hz, speed] = GetParam();
  expect_sensible(crossing(speed, rate_hz, 0.006), cameras, rate_hz);
}

TEST_P(TwoFingers, BounceOff) {
  const auto [cameras, rate_hz, speed] = GetParam();
  expect_sensible(bouncing(speed, rate_hz, 0), cameras, rate_hz);
}

TEST(TwoFingersFast, CrossOverAtFifteenFramesPerSecond) {
  // From frame to frame each other's distance shrinks by 20 mm, more than is left: two frames show them as one.
  expect_sensible(crossing(0.15, 15, 0.006), 3, 15);
}

}  // namespace
}  // namespace palpa::touch::test
