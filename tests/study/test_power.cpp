// The number of participants by simulation.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

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

TEST(Power, TheSameSeedGivesTheSameStudies) {
  PowerSetting setting{.studies = 200};
  const PowerResult one = find_power(setting), again = find_power(setting);
  ASSERT_EQ(one.rows.size(), again.rows.size());
  for (std::size_t i = 0; i < one.rows.size(); ++i)
    EXPECT_EQ(one.rows[i].found, again.rows[i].found);
}

}  // namespace
}  // namespace palpa::study
