// Plans of studies, good and bad.
#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "study/files/plan_file.hpp"

namespace palpa::study {
namespace {

const std::string good = R"([[shape]]
name = "cube"
model = "cube.glb"
[[shape]]
name = "ball"
model = "../ball.glb"
[[method]]
name = "single-focus"
[[method]]
name = "eight"
method = "cross-section"
foci = 8
stride = 3
dwell_ms = 2
layout = "own.toml"
[fit]
method = "single-focus"
accuracy = 0.6
trials = 50
)";

std::string fault_of(const std::string& text) {
  try {
    parse_plan(text, "plans/p.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::bad_input);
    return error.what();
  }
  return "";
}

/// The plan with this text instead of another.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = good;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(PlanFile, ReadsAPlan) {
  const StudyPlan plan = parse_plan(good, "plans/p.toml");
  ASSERT_EQ(plan.shapes.size(), 2u);
  EXPECT_EQ(plan.shapes[0].model, "plans/cube.glb");
  EXPECT_EQ(plan.shapes[1].model, "ball.glb");
  EXPECT_EQ(plan.methods[0].method, touch::Method::single_focus);
  EXPECT_EQ(plan.methods[0].layout, "paper");
  EXPECT_EQ(plan.methods[1].foci, 8u);
  EXPECT_EQ(plan.methods[1].stride, 3u);
  EXPECT_EQ(plan.methods[1].dwell_s, 2e-3);
  EXPECT_EQ(plan.methods[1].layout, "plans/own.toml");
  EXPECT_EQ(plan.fit.method, 0u);
  EXPECT_EQ(plan.fit.accuracy, 0.6);
  EXPECT_EQ(plan.counts.participants, 10u);
  EXPECT_EQ(plan.observer.placements, 12u);
  EXPECT_EQ(plan.touches(), 2u * 2 * 6 * 12);
}

TEST(PlanFile, OneLineForEachFault) {
  const struct {
    std::string text, fault;
  } cases[]{
      {changed("foci = 8", "focuses = 8"), "focuses"},
      {changed("stride = 3", "stride = 4"), "stride"},
      {changed("accuracy = 0.6", "accuracy = 0.5"), "accuracy must be above 0.5"},
      {changed("accuracy = 0.6", "accuracy = 1"), "below 1"},
      {changed("trials = 50", "trials = 0"), "trials"},
      {changed("trials = 50", "trials = 2.5"), "trials"},
      {changed("method = \"single-focus\"", "method = \"none\""), "method 'none' is not a [[method]] of the plan"},
      {changed("method = \"cross-section\"", "method = \"round\""), "known are cross-section, single-focus"},
      {changed("name = \"eight\"", "name = \"single-focus\""), "is there twice"},
      {changed("name = \"ball\"", "name = \"cube\""), "is there twice"},
      {changed("name = \"ball\"", "name = \"a,b\""), "without commas"},
      {changed("[[shape]]\nname = \"ball\"\nmodel = \"../ball.glb\"\n", ""),
       "a plan has 2 to 16 [[shape]], this one has 1"},
      {good + "[study]\nparticipants = 0\n", "participants"},
      {good + "[study]\npeople = 3\n", "people"},
      {good + "[observer]\nplacements = 2\n", "placements"},
      {good + "[observer]\ndepths_mm = [3, 1]\n", "ascending"},
      {good + "[observer]\ndepths_mm = []\n", "depths_mm"},
      {good + "[observer]\ncrest_mn = nan\n", "crest_mn"},
      {good + "[[candidate]]\nname = \"eight\"\nmethod = \"ellipse\"\n", "is there twice"},
      {changed("[fit]\nmethod = \"single-focus\"\naccuracy = 0.6\ntrials = 50\n", ""), "[fit] is missing"},
      {"", "[[shape]]"},
      {"[[shape]\n", "plans/p.toml"},
  };
  for (const auto& one : cases) {
    const std::string fault = fault_of(one.text);
    EXPECT_NE(fault.find(one.fault), std::string::npos) << one.fault << ": " << fault;
    EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
    EXPECT_NE(fault.find("plans/p.toml"), std::string::npos) << fault;
  }
}

}  // namespace
}  // namespace palpa::study
