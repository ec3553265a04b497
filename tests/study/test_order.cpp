// The order of a participant's session.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "study/plan/order.hpp"
#include "study/plan/plan_file.hpp"
#include "support/shared_data.hpp"

namespace palpa::study {
namespace {

StudyPlan paper() {
  return read_plan(test::source_file("assets/studies/paper.toml"));
}

std::size_t count(const StudyPlan& plan, const std::vector<Step>& steps, BlockKind kind) {
  return static_cast<std::size_t>(
      std::ranges::count_if(steps, [&](const Step& step) { return plan.blocks[step.block].kind == kind; }));
}

TEST(Order, ThePapersFirstFiveBeginWithSingleFocus) {
  const StudyPlan plan = paper();
  for (std::uint32_t participant = 1; participant <= 14; ++participant) {
    const bool single_first = participant <= 5 || (participant > 10 && participant % 2 == 1);
    EXPECT_EQ(plan.methods[methods_of(plan, participant)[0]].name, single_first ? "single-focus" : "cross-section")
        << participant;
  }
}

TEST(Order, HasThePapersNumbers) {
  const StudyPlan plan = paper();
  const std::vector<Step> steps = order_of(plan, 3);
  EXPECT_EQ(steps.size(), 2u * (4 + 1 + 1 + 40));
  EXPECT_EQ(steps.size(), count_steps(plan));
  EXPECT_EQ(count(plan, steps, BlockKind::trial), 80u);
  EXPECT_EQ(count(plan, steps, BlockKind::practice), 2u);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> shown;
  for (const Step& step : steps) {
    if (plan.blocks[step.block].kind == BlockKind::trial) ++shown[{step.method, *step.shape}];
  }
  EXPECT_EQ(shown.size(), 8u);
  for (const auto& [condition, times] : shown)
    EXPECT_EQ(times, 10);
  EXPECT_EQ(plan.shapes[*steps[5].shape].name, "semi-sphere") << "the practice";
  EXPECT_TRUE(std::ranges::is_sorted(steps, {}, &Step::round));
}

TEST(Order, DependsOnPlanAndParticipantOnly) {
  StudyPlan plan = paper();
  EXPECT_EQ(order_of(plan, 7), order_of(plan, 7));
  EXPECT_NE(order_of(plan, 6), order_of(plan, 7));
  const std::vector<Step> before = order_of(plan, 7);
  plan.run.seed = 2;
  EXPECT_NE(order_of(plan, 7), before);
}

TEST(Order, IsWrittenOutAndStaysTheSame) {
  const StudyPlan plan = paper();
  const std::string csv = order_csv(plan, order_of(plan, 1));
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "step,kind,method,shape");
  EXPECT_NE(csv.find("\n5,free,single-focus,\n6,practice,single-focus,semi-sphere\n"), std::string::npos) << csv;
  // The first trials of participant 1, for ever: a study that has begun must go on with the same order.
  const std::size_t seventh = csv.find("\n7,");
  EXPECT_EQ(csv.substr(seventh + 1, csv.find("\n11,") - seventh),
            "7,trial,single-focus,cube\n8,trial,single-focus,pyramid\n9,trial,single-focus,prism\n"
            "10,trial,single-focus,pyramid\n");
}

TEST(Order, TheFirstTrialSpreadsOverShapes) {
  const StudyPlan plan = paper();
  std::vector<int> first(4, 0);
  for (std::uint32_t participant = 1; participant <= 400; ++participant)
    ++first[*order_of(plan, participant)[6].shape];
  // Binomial(400, 1/4): standard deviation 8.7.
  for (const int times : first) {
    EXPECT_GT(times, 60);
    EXPECT_LT(times, 140);
  }
}

TEST(Order, AWilliamsSquareIsBalanced) {
  for (const std::uint32_t n : {2u, 3u, 4u, 5u, 6u, 7u}) {
    const auto rows = williams_square(n);
    ASSERT_EQ(rows.size(), n % 2 == 0 ? n : 2 * n);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> at_place, follows;
    for (const auto& row : rows) {
      EXPECT_EQ(std::set(row.begin(), row.end()).size(), n);
      for (std::uint32_t i = 0; i < n; ++i) {
        ++at_place[{i, row[i]}];
        if (i > 0) ++follows[{row[i - 1], row[i]}];
      }
    }
    EXPECT_EQ(at_place.size(), n * n);
    EXPECT_EQ(follows.size(), n * (n - 1));
    for (const auto& [pair, times] : at_place)
      EXPECT_EQ(times, rows.size() / n);
    for (const auto& [pair, times] : follows)
      EXPECT_EQ(times, rows.size() / n);
  }
}

TEST(Order, RulesForTwoMethods) {
  StudyPlan plan = paper();
  const std::vector<std::uint32_t> forward{0, 1}, backward{1, 0};
  plan.run.order = OrderRule::alternate;
  EXPECT_EQ(methods_of(plan, 1), forward);
  EXPECT_EQ(methods_of(plan, 2), backward);
  EXPECT_EQ(methods_of(plan, 6), backward);
  plan.run.order = OrderRule::williams;
  EXPECT_EQ(methods_of(plan, 1), forward);
  EXPECT_EQ(methods_of(plan, 2), backward);
  plan.run.order = OrderRule::fixed;
  EXPECT_EQ(methods_of(plan, 2), forward);
  plan.run.order = OrderRule::halves;
  plan.counts.participants = 7;
  EXPECT_EQ(methods_of(plan, 4), forward);
  EXPECT_EQ(methods_of(plan, 5), backward);
}

TEST(Order, NoShapeTwiceInARow) {
  StudyPlan plan = paper();
  plan.blocks = {{.kind = BlockKind::trial, .shapes = {0, 1}, .repeats = 10, .apart = true},
                 {.kind = BlockKind::trial, .shapes = {0, 1, 2, 3}, .repeats = 10, .apart = true}};
  std::set<std::uint32_t> orders;
  for (std::uint32_t participant = 1; participant <= 50; ++participant) {
    const std::vector<Step> steps = order_of(plan, participant);
    ASSERT_EQ(steps.size(), 2u * 60);
    orders.insert(steps[20].shape.value() * 10000 + steps[25].shape.value() * 100 + steps[30].shape.value());
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> shown;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      ++shown[{steps[i].round, *steps[i].shape}];
      if (i > 0 && steps[i].round == steps[i - 1].round) {
        EXPECT_NE(steps[i].shape, steps[i - 1].shape);
      }
    }
    for (const auto& [place, times] : shown)
      EXPECT_EQ(times, 10);
  }
  EXPECT_GT(orders.size(), 25u) << "of 64: chance decides which shape comes where";
}

TEST(Order, RepeatsAndBlocksThatComeOnce) {
  StudyPlan plan = paper();
  plan.blocks = {{.kind = BlockKind::rest, .once = true},
                 {.kind = BlockKind::practice, .shapes = {2, 0, 1}, .repeats = 2},
                 {.kind = BlockKind::trial, .shapes = {0, 1}, .repeats = 3}};
  const std::vector<Step> steps = order_of(plan, 4);
  EXPECT_EQ(steps.size(), count_steps(plan));
  EXPECT_EQ(count(plan, steps, BlockKind::rest), 1u);
  EXPECT_EQ(count(plan, steps, BlockKind::practice), 2u * 6);
  EXPECT_EQ(count(plan, steps, BlockKind::trial), 2u * 6);
  EXPECT_FALSE(steps[0].shape);
  const std::uint32_t practised[]{2, 0, 1, 2, 0, 1};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(steps[1 + i].shape, practised[i]) << "in the order of the plan";
}

}  // namespace
}  // namespace palpa::study
