// How fingers share an array that cannot give all of them everything that they ask for.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "array/field/free_field.hpp"
#include "array/layouts/layout.hpp"
#include "array/levels.hpp"
#include "array/pressures/many_foci.hpp"

namespace palpa::array {
namespace {

std::vector<double> levels_of(const std::vector<Demand>& demands, double budget = 1) {
  std::vector<double> levels(demands.size());
  share_out(demands, budget, levels);
  return levels;
}

double taken(const std::vector<Demand>& demands, const std::vector<double>& levels) {
  double sum = 0;
  for (std::size_t f = 0; f < demands.size(); ++f)
    sum += levels[f] > 0 ? demands[f].takes * levels[f] : 0;
  return sum;
}

TEST(Levels, FingersThatCouldEachHaveItAloneAreLoweredByOneFactor) {
  for (const double level : levels_of({{0.8}, {0.4}, {0.8}}))
    EXPECT_DOUBLE_EQ(level, 0.5);
}

TEST(Levels, OneThatCannotBeReachedLowersNobodyElse) {
  for (const double takes : {1.4, 2.0, 50.0, 1e6, 1e13}) {
    const std::vector<double> levels = levels_of({{0.6}, {takes}, {0.3}});
    EXPECT_DOUBLE_EQ(levels[0], 1) << takes;
    EXPECT_DOUBLE_EQ(levels[2], 1) << takes;
    // It takes the rest, or nothing if no sound of it arrives.
    EXPECT_NEAR(levels[1], takes > 1e12 ? 0 : 0.1 / takes, 1e-12) << takes;
  }
  // A finger that needs at least a third too much does not lower one that needs nearly all, either.
  EXPECT_GT(levels_of({{0.999}, {4.0 / 3}})[0], 0.985);
}

TEST(Levels, FingersWithoutAPressureHaveWhatIsLeft) {
  const std::vector<double> levels = levels_of({{0.7}, {1, false}, {0.2}});
  EXPECT_DOUBLE_EQ(levels[0], 1);
  EXPECT_NEAR(levels[1], 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(levels[2], 1);
  EXPECT_NEAR(levels_of({{5}, {1, false}})[1], 0, 1e-12);
}

TEST(Levels, SeveralThatCannotBeReachedShareAndWhatTakesNothingIsFull) {
  EXPECT_TRUE(levels_of({}).empty());
  EXPECT_EQ(levels_of({{0}, {1}}), (std::vector<double>{1, 1}));
  const std::vector<double> levels = levels_of({{3}, {3}});
  EXPECT_DOUBLE_EQ(levels[0], levels[1]);
  EXPECT_DOUBLE_EQ(levels[0], 1.0 / 6);
}

TEST(Levels, NoFingerJumpsWhereAnotherCrossesTheBorderOfWhatCanBeReached) {
  double before = levels_of({{0.7}, {0.9}})[0];
  for (double takes = 0.9; takes < 2; takes += 1e-3) {
    const double now = levels_of({{0.7}, {takes}})[0];
    EXPECT_NEAR(now, before, 0.006) << takes;
    before = now;
  }
}

TEST(ManyFoci, AFingerThatIsTooLoudIsLoweredAsAWhole) {
  using Complex = std::complex<double>;
  const Layout layout = load_layout("openmpd");
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  std::vector<SlotFocus> foci{{{-0.02, 0, 0.15}}, {{0.02, 0, 0.15}}, {{0, 0.04, 0.15}}};
  foci[2].voice = 1;
  std::vector<FocusSource> sources;
  for (const SlotFocus& focus : foci)
    sources.push_back({focus.position, 1, 1});
  const std::vector<Complex> asked{{0.3, 0}, {0, 0.1}, {0.1, 0}};
  std::vector<Complex> factors = asked, heard(3);
  Columns columns;
  hear_all(field, layout, sources, Weighting::uniform, factors, columns, heard);
  foci[0].most_pa = 0.5 * layout.source_level_pa_m * std::abs(heard[0]);
  keep_below(field, layout, foci, sources, Weighting::uniform, factors, columns, heard);
  EXPECT_LE(layout.source_level_pa_m * std::abs(heard[0]), *foci[0].most_pa * (1 + 1e-9));
  EXPECT_LT(std::abs(factors[0]), 0.16);
  EXPECT_LT(std::abs(factors[1] / factors[0] - asked[1] / asked[0]), 1e-12) << "one factor for all of its foci";
  EXPECT_GT(std::abs(factors[2]), 0.06) << "the other finger";
}

RC_GTEST_PROP(Levels, AreBoundedAndUseAllThatThereIs, ()) {
  const auto count = *rc::gen::inRange<std::size_t>(1, 65);
  std::vector<Demand> demands(count);
  double most = 0;
  for (Demand& demand : demands) {
    demand = {1e-3 * *rc::gen::inRange(0, 4000), *rc::gen::inRange(0, 8) != 0};
    most += std::min(demand.takes, 1.0);
  }
  const double budget = 1 + 1e-2 * *rc::gen::inRange(0, 300);
  const std::vector<double> levels = levels_of(demands, budget);
  for (std::size_t f = 0; f < count; ++f) {
    RC_ASSERT(levels[f] >= 0 && levels[f] <= 1);
    RC_ASSERT(levels[f] * demands[f].takes <= 1 + 1e-9);
  }
  RC_ASSERT(std::abs(taken(demands, levels) - std::min(budget, most)) < 1e-6);
}

}  // namespace
}  // namespace palpa::array
