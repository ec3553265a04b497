// Friedman's test, the rank-sum test and Holm's correction.
#include <gtest/gtest.h>

#include <vector>

#include "study/statistics/rank_tests.hpp"

namespace palpa::study {
namespace {

TEST(RankTests, FriedmanOfHollanderAndWolfesRunners) {
  // Times to round first base in three ways (Hollander and Wolfe, table 7.1): chi-square 11.143, p 0.003805, as in R's
  // example of friedman.test.
  const std::vector<std::vector<double>> rows{
      {5.40, 5.50, 5.55}, {5.85, 5.70, 5.75}, {5.20, 5.60, 5.50}, {5.55, 5.50, 5.40}, {5.90, 5.85, 5.70},
      {5.45, 5.55, 5.60}, {5.40, 5.40, 5.35}, {5.45, 5.50, 5.35}, {5.25, 5.15, 5.00}, {5.85, 5.80, 5.70},
      {5.25, 5.20, 5.10}, {5.65, 5.55, 5.45}, {5.60, 5.35, 5.45}, {5.05, 5.00, 4.95}, {5.50, 5.50, 5.40},
      {5.45, 5.55, 5.50}, {5.55, 5.55, 5.35}, {5.45, 5.50, 5.55}, {5.50, 5.45, 5.25}, {5.65, 5.60, 5.40},
      {5.70, 5.65, 5.55}, {6.30, 6.30, 6.25}};
  const Friedman test = friedman(rows);
  EXPECT_NEAR(test.chi_square, 11.143, 5e-4);
  EXPECT_EQ(test.degrees, 2);
  EXPECT_NEAR(test.p, 0.003805, 5e-7);
  EXPECT_EQ(friedman({{1, 1, 1}, {2, 2, 2}}).p, 1) << "nothing differs";
}

TEST(RankTests, RankSumCountsAllWaysToDivideThePeople) {
  // 3 of 6, the three largest: 1 of 20 ways, twice for both sides.
  const std::vector<double> low{1, 2, 3}, high{4, 5, 6};
  EXPECT_NEAR(rank_sum(high, low).p, 0.1, 1e-15);
  EXPECT_EQ(rank_sum(high, low).sum, 15);
  EXPECT_NEAR(rank_sum(low, high).p, 0.1, 1e-15);
  // All the same: every way has this sum.
  const std::vector<double> same{2, 2, 2};
  EXPECT_EQ(rank_sum(same, same).p, 1);
  EXPECT_EQ(rank_sum(low, {}).p, 1);
}

TEST(RankTests, ManyPeopleAreApproximated) {
  std::vector<double> a, b;
  for (int i = 0; i < 40; ++i) {
    a.push_back(i);
    b.push_back(i + 9.5);
  }
  const RankSum test = rank_sum(a, b);
  EXPECT_FALSE(test.exact);
  EXPECT_GT(test.p, 0.0005);
  EXPECT_LT(test.p, 0.02);
}

TEST(RankTests, HolmMultipliesByTheTestsThatAreLeft) {
  const std::vector<double> corrected = holm(std::vector<double>{0.01, 0.04, 0.03});
  ASSERT_EQ(corrected.size(), 3u);
  EXPECT_NEAR(corrected[0], 0.03, 1e-15);
  EXPECT_NEAR(corrected[1], 0.06, 1e-15) << "never less than a smaller p's";
  EXPECT_NEAR(corrected[2], 0.06, 1e-15);
  EXPECT_EQ(holm(std::vector<double>{0.9, 0.8})[0], 1);
}

}  // namespace
}  // namespace palpa::study
