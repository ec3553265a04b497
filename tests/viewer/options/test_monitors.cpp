// Two windows on one monitor.
#include <gtest/gtest.h>

#include "viewer/options/monitors.hpp"

namespace palpa::viewer {
namespace {

constexpr WindowPlace area{0, 30, 1920, 1050};

TEST(SideBySide, LeavesWindowsThatDoNotOverlap) {
  EXPECT_FALSE(side_by_side(area, {10, 40, 900, 620}, {920, 40, 960, 600}, false));
  EXPECT_TRUE(side_by_side(area, {10, 40, 900, 620}, {920, 40, 1280, 800}, false)) << "a part is off the monitor";
}

TEST(SideBySide, SeparatesWindowsThatFit) {
  const auto places = side_by_side(area, {0, 30, 900, 620}, {0, 30, 960, 600}, false);
  ASSERT_TRUE(places);
  EXPECT_EQ(*places, (TwoPlaces{{0, 30, 900, 620}, {900, 30, 960, 600}}));
}

TEST(SideBySide, ThePictureKeepsItsShape) {
  const auto places = side_by_side({0, 0, 1280, 1024}, {0, 0, 900, 620}, {0, 0, 1280, 800}, false);
  ASSERT_TRUE(places);
  EXPECT_EQ(*places, (TwoPlaces{{0, 0, 640, 620}, {640, 0, 640, 400}}));
}

TEST(SideBySide, ASizeThatWasAskedForIsKept) {
  const auto places = side_by_side({0, 0, 1280, 1024}, {0, 0, 900, 620}, {0, 0, 800, 600}, true);
  ASSERT_TRUE(places);
  EXPECT_EQ(*places, (TwoPlaces{{0, 0, 480, 620}, {480, 0, 800, 600}}));
}

}  // namespace
}  // namespace palpa::viewer
