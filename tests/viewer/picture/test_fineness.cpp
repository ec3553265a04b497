// When pictures are drawn finely.
#include <gtest/gtest.h>

#include "viewer/view/fineness.hpp"

namespace palpa::viewer {
namespace {

constexpr FinePictures automatic = FinePictures::automatic;

TEST(Fineness, WhatMovesIsQuickAndWhatRestsIsFine) {
  Rest rest;
  const auto draw = [&](double now_s, bool changed) {
    const Fineness fineness = rest.next(automatic, true, changed, now_s);
    rest.drew(automatic, fineness, now_s);
    return fineness;
  };
  EXPECT_EQ(draw(5, true), Fineness::fine) << "the first";
  EXPECT_FALSE(rest.again_s());
  EXPECT_EQ(draw(5.1, true), Fineness::quick);
  ASSERT_TRUE(rest.again_s());
  EXPECT_DOUBLE_EQ(*rest.again_s(), 5.25);
  EXPECT_EQ(draw(5.25, false), Fineness::fine);
  EXPECT_FALSE(rest.again_s()) << "an unchanged window costs nothing";
  EXPECT_EQ(draw(9, true), Fineness::fine) << "a single change after a rest";
  EXPECT_EQ(draw(9 + 1.0 / 15, true), Fineness::quick) << "a replay at 15 Hz";
  EXPECT_EQ(draw(9.25, true), Fineness::fine) << "slots, four a second";
}

TEST(Fineness, AQuickDeviceDrawsAllFine) {
  Rest rest;
  for (const double now_s : {1.0, 1.01, 1.02}) {
    EXPECT_EQ(rest.next(automatic, false, true, now_s), Fineness::fine);
    rest.drew(automatic, Fineness::fine, now_s);
    EXPECT_FALSE(rest.again_s());
  }
}

TEST(Fineness, IsAsItIsAskedFor) {
  Rest rest;
  for (const bool changed : {true, true, false}) {
    EXPECT_EQ(rest.next(FinePictures::always, true, changed, 1), Fineness::fine);
    EXPECT_EQ(rest.next(FinePictures::never, true, changed, 1), Fineness::quick);
    rest.drew(FinePictures::never, Fineness::quick, 1);
    EXPECT_FALSE(rest.again_s()) << "never again, then";
  }
}

}  // namespace
}  // namespace palpa::viewer
