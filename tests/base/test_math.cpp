#include <gtest/gtest.h>

#include "base/math.hpp"

namespace palpa {
namespace {

// A quarter turn about z that takes x to y, then a shift: T_a_b exactly as defined.
Transform quarter_turn() {
  Transform T_a_b(0.0);
  T_a_b[0] = Vec4(0, 1, 0, 0);  // GLM indexes columns: the direction of b's x axis in a
  T_a_b[1] = Vec4(-1, 0, 0, 0);
  T_a_b[2] = Vec4(0, 0, 1, 0);
  T_a_b[3] = Vec4(10, 20, 30, 1);
  return T_a_b;
}

TEST(Math, TransformsTakePointsAndDirectionsFromBToAAndChain) {
  EXPECT_EQ(transform_point(quarter_turn(), Vec3(1, 2, 3)), Vec3(8, 21, 33));
  EXPECT_EQ(transform_direction(quarter_turn(), Vec3(1, 2, 3)), Vec3(-2, 1, 3));
  const Transform T_a_c = quarter_turn() * quarter_turn();
  EXPECT_EQ(transform_point(T_a_c, Vec3(1, 2, 3)),
            transform_point(quarter_turn(), transform_point(quarter_turn(), Vec3(1, 2, 3))));
}

TEST(Box, StartsEmptyAndGrowsToItsPoints) {
  Box box;
  EXPECT_TRUE(box.empty());
  box.add({1, -2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.low, box.high);
  box.add({-1, 2, 5});
  EXPECT_EQ(box.low, Vec3(-1, -2, 3));
  EXPECT_EQ(box.high, Vec3(1, 2, 5));
  EXPECT_EQ(box.centre(), Vec3(0, 0, 4));
}

}  // namespace
}  // namespace palpa
