// The number of participants by simulation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "base/random.hpp"
#include "study/power.hpp"

namespace palpa::study {
namespace {

TEST(Power, OfThePapersEffect) {
  const PowerResult result = find_power({});
  ASSERT_TRUE(result.people);
  // Six are the least with whom p can be below 0.05, and the effect is large.
  EXPECT_EQ(*result.people, 6u);
  ASSERT_FALSE(result.rows.empty());
  for (const PowerRow& row : result.rows) {
    EXPECT_LE(row.interval.low, row.power);
    EXPECT_GE(row.interval.high, row.power);
    if (row.people < 6) {
      EXPECT_EQ(row.found, 0u) << row.people;
    }
  }
}

TEST(Power, AlphaItselfIsEnough) {
  PowerSetting setting;
  setting.alpha = 2.0 / 64;  // the least p of six people
  EXPECT_EQ(find_power(setting).people, 6u);
  setting.alpha = std::nextafter(setting.alpha, 0);
  EXPECT_GT(find_power(setting).people.value(), 6u);
}

TEST(Power, WithoutAnEffectIsAtMostAlpha) {
  PowerSetting setting{.a = 0.5, .b = 0.5};
  setting.most_people = 12;
  setting.alpha = 0.05;
  const PowerResult result = find_power(setting);
  EXPECT_FALSE(result.people);
  EXPECT_LE(result.rows.back().interval.low, 0.05) << "an exact test finds too much by chance no more often than alpha";
}

TEST(Power, ASmallerEffectNeedsMore) {
  PowerSetting setting{.a = 0.5, .b = 0.58};
  setting.studies = 500;
  const PowerResult small = find_power(setting);
  ASSERT_TRUE(small.people);
  EXPECT_GT(*small.people, 10u);
  EXPECT_LT(*small.people, 60u);
  setting.b = 0.65;
  EXPECT_LT(find_power(setting).people.value(), *small.people);
}

/// The paper's correlation is one of ten people: the result is shown for its whole interval.
TEST(Power, AnUncertainCorrelationGivesARange) {
  PowerSetting setting{.a = 0.5, .b = 0.58};
  setting.studies = 500;
  const std::vector<OtherCorrelation> others = at_other_correlations(setting);
  ASSERT_EQ(others.size(), 2u);
  const std::uint32_t people = find_power(setting).people.value();
  EXPECT_EQ(others[0].correlation, 0.27);
  EXPECT_GT(others[0].people.value(), people);
  EXPECT_LT(others[1].people.value(), people);
  setting.correlation = 0.5;
  EXPECT_TRUE(at_other_correlations(setting).empty()) << "somebody knows it";
}

/// Nobody has an accuracy above 1, so the mean of many people around 0.95 is lower.
TEST(Power, BoundsMoveTheMean) {
  EXPECT_DOUBLE_EQ(mean_within_bounds(0.6, 0), 0.6);
  EXPECT_NEAR(mean_within_bounds(0.6525, 0.1), 0.6525, 1e-4) << "the paper's";
  EXPECT_NEAR(mean_within_bounds(1, 0.1), 1 - 0.1 / std::sqrt(2 * std::numbers::pi), 1e-12);
  EXPECT_NEAR(mean_within_bounds(0, 0.1), 0.1 / std::sqrt(2 * std::numbers::pi), 1e-12);
  for (const double mean : {0.95, 0.1}) {
    Random random(1);
    double sum = 0;
    constexpr int people = 400'000;
    for (int i = 0; i < people; ++i)
      sum += std::clamp(mean + 0.2 * random.normal(), 0.0, 1.0);
    EXPECT_NEAR(mean_within_bounds(mean, 0.2), sum / people, 1e-3) << mean;
  }
}

TEST(Power, TheSameSeedGivesTheSameStudies) {
  PowerSetting setting{.studies = 200};
  const PowerResult one = find_power(setting), again = find_power(setting);
  ASSERT_EQ(one.rows.size(), again.rows.size());
  for (std::size_t i = 0; i < one.rows.size(); ++i)
    EXPECT_EQ(one.rows[i].found, again.rows[i].found);
}

}  // namespace
}  // namespace palpa::study
