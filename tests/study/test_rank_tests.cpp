// Tests of ranks against published data: Wilcoxon's, also against all signs of small samples, Friedman's and the rank
// sum; Holm's correction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "study/statistics/rank_tests.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/wilcoxon.hpp"

namespace palpa::study {
namespace {

const std::vector<double> zeros_and_ties{0, 0, 1, -1, 2, 2, -2, 3, 4, 5};

struct KnownTest {
  const char* of;
  std::vector<double> differences;
  struct {
    double positive, negative, greater, less, two_sided, normal, normal_corrected;
  } is;
};
const std::vector<KnownTest> known_tests{
    // The correct answers of 40 with one method less those with the other: all in one direction, which is the least p
    // that ten people can give. The normal approximation corrects for ties.
    {"ten participants",
     {10, 14, 10, 8, 14, 8, 14, 10, 9, 8},
     {55, 0, 1.0 / 1024, 1, 2.0 / 1024, 0.004725697734, 0.005540680462}},
    {"Hollander and Wolfe's depressions",
     {1.83 - .878, .50 - .647, 1.62 - .598, 2.48 - 2.05, 1.68 - 1.06, 1.88 - 1.29, 1.55 - 1.06, 3.06 - 3.14, .01},
     {40, 5, 0.01953125, 0.986328125, 0.0390625, 0.03815171017, 0.04401098401}},
    {"Darwin's maize",
     {49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48},
     {96, 24, 0.0206298828125, 0.982330322265625, 0.041259765625, 0.04088813291, 0.04377232376}},
};

TEST(Wilcoxon, OfPublishedData) {
  for (const KnownTest& known : known_tests) {
    SCOPED_TRACE(known.of);
    const SignedRank test = wilcoxon(known.differences);
    EXPECT_TRUE(test.exact);
    EXPECT_EQ(test.positive, known.is.positive);
    EXPECT_EQ(test.negative, known.is.negative);
    EXPECT_NEAR(test.greater, known.is.greater, 1e-11);
    EXPECT_NEAR(test.less, known.is.less, 1e-11);
    EXPECT_NEAR(test.two_sided, known.is.two_sided, 1e-11);
    EXPECT_NEAR(test.normal, known.is.normal, 1e-11);
    EXPECT_NEAR(test.normal_corrected, known.is.normal_corrected, 1e-11);
  }
}

TEST(Wilcoxon, ZerosAndTiesInTwoWays) {
  const SignedRank drop = wilcoxon(zeros_and_ties, Zeros::drop);
  EXPECT_EQ(drop.positive, 30.5);
  EXPECT_EQ(drop.nonzero, 8u);
  EXPECT_NEAR(drop.two_sided, 0.1015625, 1e-15);
  EXPECT_NEAR(drop.greater, 0.05078125, 1e-15);
  EXPECT_NEAR(drop.normal, 0.07820880762, 1e-11);
  EXPECT_NEAR(drop.normal_corrected, 0.09088878525, 1e-11);
  const SignedRank pratt = wilcoxon(zeros_and_ties, Zeros::pratt);
  EXPECT_EQ(pratt.positive, 42.5);
  EXPECT_NEAR(pratt.two_sided, 0.1171875, 1e-15);
  EXPECT_NEAR(pratt.greater, 0.05859375, 1e-15);
  EXPECT_NEAR(pratt.normal, 0.0894208739, 1e-10);
  EXPECT_NEAR(pratt.normal_corrected, 0.09955968187, 1e-11);
}

/// Two-sided p by trying all signs.
double by_enumeration(const std::vector<double>& differences) {
  std::vector<double> sizes;
  for (const double d : differences) {
    if (d != 0) sizes.push_back(std::abs(d));
  }
  const std::vector<double> ranks = midranks(sizes).of;
  double observed = 0;
  std::size_t i = 0;
  for (const double d : differences) {
    if (d == 0) continue;
    observed += d > 0 ? ranks[i] : 0;
    ++i;
  }
  double at_least = 0, at_most = 0;
  const std::uint32_t all = 1u << ranks.size();
  for (std::uint32_t signs = 0; signs < all; ++signs) {
    double sum = 0;
    for (std::size_t k = 0; k < ranks.size(); ++k)
      sum += (signs >> k & 1) != 0 ? ranks[k] : 0;
    at_least += sum >= observed ? 1 : 0;
    at_most += sum <= observed ? 1 : 0;
  }
  return std::min(1.0, 2 * std::min(at_least, at_most) / all);
}

TEST(Wilcoxon, IsThePermutationDistributionWithAnyTiesAndZeros) {
  std::uint32_t state = 1;
  for (int round = 0; round < 60; ++round) {
    std::vector<double> differences;
    const int n = 1 + round % 11;
    for (int i = 0; i < n; ++i) {
      state = state * 1664525 + 1013904223;
      differences.push_back(static_cast<double>(state >> 28) - 6);
    }
    EXPECT_NEAR(wilcoxon(differences).two_sided, by_enumeration(differences), 1e-12) << round;
  }
}

TEST(Wilcoxon, TheOrderOfTheSamplesDoesNotMatter) {
  std::vector<double> turned;
  for (const double d : zeros_and_ties)
    turned.push_back(-d);
  const SignedRank one = wilcoxon(zeros_and_ties), other = wilcoxon(turned);
  EXPECT_EQ(one.two_sided, other.two_sided);
  EXPECT_EQ(one.greater, other.less);
}

TEST(Wilcoxon, WithoutADifferenceThereIsNothing) {
  for (const std::vector<double>& d : {std::vector<double>{}, {0, 0, 0}}) {
    const SignedRank test = wilcoxon(d);
    EXPECT_EQ(test.two_sided, 1);
    EXPECT_EQ(test.nonzero, 0u);
  }
}

TEST(Wilcoxon, ManyDifferencesAreApproximated) {
  std::vector<double> differences;
  for (int i = 1; i <= 300; ++i)
    differences.push_back(i % 3 == 0 ? -i : i);
  const SignedRank many = wilcoxon(differences);
  EXPECT_FALSE(many.exact);
  EXPECT_EQ(many.two_sided, many.normal);
  differences.resize(most_exact_pairs);
  const SignedRank fewer = wilcoxon(differences);
  EXPECT_TRUE(fewer.exact);
  EXPECT_NEAR(std::log(fewer.two_sided), std::log(fewer.normal), 0.5);
}

TEST(Wilcoxon, CriticalValuesOfTen) {
  EXPECT_EQ(signed_rank_index(10, 0.025), 9u);
  EXPECT_EQ(signed_rank_index(10, 0.005), 4u);
  EXPECT_EQ(signed_rank_index(5, 0.025), 0u) << "five differences have no interval of 95 %";
  EXPECT_EQ(signed_rank_index(6, 0.025), 1u);
}

TEST(Ranks, EqualQuotientsOfWholeNumbersAreTies) {
  // As doubles, 0.70 - 0.45 and 0.80 - 0.55 differ.
  const Ranks ranks = midranks(std::vector<double>{10.0 / 40, 10.0 / 40, 100.0 / 400, 8.0 / 40});
  EXPECT_EQ(ranks.of, (std::vector<double>{3, 3, 3, 1}));
  EXPECT_EQ(ranks.tie_sum(), 24);
}

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
