// Means, correlations, Hodges-Lehmann and the bootstrap, of ten participants whose statistics are known.
#include <gtest/gtest.h>

#include <vector>

#include "study/statistics/paired.hpp"

namespace palpa::study {
namespace {

const std::vector<double> single{.45, .30, .55, .25, .40, .35, .50, .275, .375, .45};
const std::vector<double> cross{.70, .65, .80, .45, .75, .55, .85, .525, .60, .65};
/// From whole numbers, divided once.
std::vector<double> differences() {
  std::vector<double> d;
  for (const int answers : {10, 14, 10, 8, 14, 8, 14, 10, 9, 8})
    d.push_back(answers / 40.0);
  return d;
}

TEST(Samples, DifferencesOfTen) {
  const std::vector<double> d = differences();
  EXPECT_NEAR(mean(d), 0.2625, 1e-15);
  const auto interval = t_interval(d);
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, 0.2169047648, 1e-10);
  EXPECT_NEAR(interval->high, 0.3080952353, 1e-10);
  EXPECT_NEAR(cohens_d(d).value(), 4.118438838, 1e-9);
  const HodgesLehmann found = hodges_lehmann(d);
  EXPECT_EQ(found.estimate, 0.25);
  ASSERT_TRUE(found.interval);
  EXPECT_NEAR(found.interval->low, 0.2125, 1e-15);
  EXPECT_NEAR(found.interval->high, 0.30, 1e-15);
}

TEST(Samples, CorrelationsOfTen) {
  const auto linear = pearson(single, cross), ranked = spearman(single, cross);
  ASSERT_TRUE(linear && ranked);
  EXPECT_NEAR(linear->r, 0.866851219, 1e-9);
  EXPECT_NEAR(linear->p, 0.001167325963, 1e-11);
  EXPECT_NEAR(ranked->r, 0.887195122, 1e-9);
  EXPECT_NEAR(ranked->p, 0.0006169570338, 1e-12);
}

TEST(Samples, RanksThatAgreeHaveAnExactP) {
  const std::vector<double> up{1, 2, 4}, also_up{0.1, 0.5, 0.6}, down{3, 2, 1};
  EXPECT_EQ(spearman(up, also_up)->r, 1);
  EXPECT_NEAR(spearman(up, also_up)->p, 2.0 / 6, 1e-15);
  EXPECT_EQ(spearman(up, down)->r, -1);
  EXPECT_NEAR(spearman(up, down)->p, 2.0 / 6, 1e-15);
  // Ranks with one tie at the end have twelve orders: one agrees, none is reversed. With a tie on both sides, one is.
  const std::vector<double> one_tie{1, 2, 3, 3}, two_ties{1, 1, 2, 2};
  EXPECT_NEAR(spearman(one_tie, one_tie)->p, 1.0 / 12, 1e-15);
  EXPECT_NEAR(spearman(two_ties, two_ties)->p, 2.0 / 6, 1e-15);
  const std::vector<double> eight{1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_NEAR(spearman(eight, eight)->p, 2.0 / 40320, 1e-18);
}

TEST(Samples, ThePapersCorrelation) {
  const Correlation paper = correlation_of(0.77, 10);
  EXPECT_NEAR(paper.p, 0.009177152, 1e-9);
  ASSERT_TRUE(paper.interval);
  EXPECT_NEAR(paper.interval->low, 0.2725, 5e-5);
  EXPECT_NEAR(paper.interval->high, 0.9426, 5e-5);
}

TEST(Samples, TheBootstrapResamplesPeople) {
  const auto interval = bootstrap_mean(differences(), 0, 100'000);
  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, 0.2275, 0.0026);
  EXPECT_NEAR(interval->high, 0.3000, 0.0026);
  const auto again = bootstrap_mean(differences(), 0, 100'000);
  EXPECT_EQ(again->low, interval->low);
  EXPECT_EQ(bootstrap_resamples(10), 100'000u);
  EXPECT_EQ(bootstrap_resamples(1000), 20'000u);
}

TEST(Samples, TooFewValuesHaveNoInterval) {
  const std::vector<double> one{0.5}, same{0.1, 0.1, 0.1};
  EXPECT_FALSE(standard_deviation(one) || t_interval(one) || bootstrap_mean(one, 0, 100));
  EXPECT_FALSE(cohens_d(same)) << "the mean of equal values over a deviation of 0";
  EXPECT_FALSE(pearson(same, same));
  EXPECT_FALSE(hodges_lehmann(one).interval);
  EXPECT_EQ(hodges_lehmann(one).estimate, 0.5);
}

}  // namespace
}  // namespace palpa::study
