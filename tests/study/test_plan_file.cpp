// Plans of studies, good and bad.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "study/plan/plan_file.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

const std::string good = R"([[shape]]
name = "cube"
model = "cube.glb"
[[shape]]
name = "ball"
model = "../ball.glb"
labels = { de = "Kugel" }
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
  return test::error_of([&] { parse_plan(text, "plans/p.toml"); });
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
  EXPECT_FALSE(plan.methods[0].layout_given);
  EXPECT_TRUE(plan.methods[1].layout_given);
  EXPECT_EQ(plan.methods[1].foci, 8u);
  EXPECT_EQ(plan.methods[1].stride, 3u);
  EXPECT_EQ(plan.methods[1].dwell_s, 2e-3);
  EXPECT_EQ(plan.methods[1].layout, "plans/own.toml");
  EXPECT_EQ(plan.fit.method, 0u);
  EXPECT_EQ(plan.fit.accuracy, 0.6);
  EXPECT_EQ(plan.counts.participants, 10u);
  EXPECT_EQ(plan.observer.placements, 12u);
  EXPECT_EQ(plan.touches(), 2u * 2 * 6 * 12);
  refuse_without_fit(plan);
  const StudyPlan own = parse_plan(changed("\"../ball.glb\"", "\"palpa:ball.glb\""), "plans/p.toml");
  EXPECT_EQ(own.shapes[1].model, "palpa:ball.glb") << "not from the plan's folder";
}

TEST(PlanFile, FixesTheLeastTrialsOfAComparison) {
  EXPECT_EQ(parse_plan(good, "p.toml").counts.least_trials, 15u) << "three quarters of two shapes, ten times";
  EXPECT_EQ(parse_plan(good + "[study]\ntrials_per_shape = 3\n", "p.toml").counts.least_trials, 5u);
  EXPECT_EQ(parse_plan(good + "[study]\nleast_trials = 20\n", "p.toml").counts.least_trials, 20u);
  EXPECT_CONTAINS(fault_of(good + "[study]\nleast_trials = 21\n"), "a participant has only 20 trials with each method");
}

TEST(PlanFile, WithoutBlocksItIsThePapersProcedure) {
  const StudyPlan plan = parse_plan(good + "[study]\ntrials_per_shape = 4\ntouch_s = 2\n", "p.toml");
  ASSERT_EQ(plan.blocks.size(), 4u);
  EXPECT_EQ(plan.blocks[0].kind, BlockKind::familiarise);
  EXPECT_EQ(plan.blocks[1].touch_s, 180);
  EXPECT_EQ(plan.blocks[2].shapes, std::vector<std::uint32_t>{0});
  EXPECT_EQ(plan.blocks[3].repeats, 4u);
  EXPECT_EQ(plan.run.order, OrderRule::halves);
  // Two methods: 2 shapes, 180 s, 1 practice, 8 trials.
  EXPECT_DOUBLE_EQ(sounding_s(plan), 2 * (2 * 2 + 180 + 2 + 8 * 2.0));
}

TEST(PlanFile, ReadsBlocksAndTexts) {
  const StudyPlan plan = parse_plan(good + R"([run]
masking = "sound.wav"
order = "williams"
deep_mm = 10
predict = false
hysteresis = "off"
[level]
ceiling = 0.25
left_ear_mm = [-70, 300, 400]
[[block]]
kind = "rest"
rest_s = 30
once = true
[[block]]
kind = "practice"
repeats = 2
feedback = true
[[block]]
kind = "familiarise"
shapes = ["ball"]
text = "How round?"
[texts.en]
end = "Bye"
)",
                                    "plans/p.toml");
  EXPECT_EQ(plan.run.masking, "plans/sound.wav");
  EXPECT_EQ(plan.run.deep_m, 10e-3);
  EXPECT_FALSE(plan.run.predict);
  EXPECT_EQ(plan.run.hysteresis, touch::Hysteresis::off);
  EXPECT_EQ(plan.level.ceiling, 0.25);
  EXPECT_EQ(plan.level.ears[0], Vec3(-0.07, 0.3, 0.4));
  ASSERT_EQ(plan.blocks.size(), 3u);
  EXPECT_TRUE(plan.blocks[0].once);
  EXPECT_TRUE(plan.blocks[1].feedback);
  EXPECT_EQ(instruction_of(plan, plan.blocks[2]), "How round?");
  EXPECT_EQ(plan.text(TextId::end), "Bye");
  EXPECT_NE(plan.text(TextId::consent), "");
  // Two methods: 2 shapes practised twice for 10 s, and one that is shown.
  EXPECT_DOUBLE_EQ(sounding_s(plan), 2 * (2 * 2 * 10 + 10));
}

TEST(PlanFile, AnotherLanguageHasEveryText) {
  std::string texts = "[texts.de]\n";
  for (const DefaultText& text : default_texts())
    texts += std::string(text.key) + " = \"Ein Text\"\n";
  const StudyPlan plan = parse_plan("language = \"de\"\n" + good + texts, "p.toml");
  EXPECT_EQ(plan.text(TextId::trial), "Ein Text");
  EXPECT_EQ(plan.label(0), "cube");
  EXPECT_EQ(plan.label(1), "Kugel");
  EXPECT_CONTAINS(fault_of("language = \"de\"\n" + good + "[texts.de]\nend = \"Ende\"\n"), "[texts.de] has no consent");
  EXPECT_CONTAINS(fault_of("language = \"de\"\n" + good), "there is no [texts.de]");
}

TEST(PlanFile, OneLineForEachFault) {
  const std::string block = good + "[[block]]\n";
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
      {changed("method = \"cross-section\"", "method = \"round\""), "should be cross-section, single-focus"},
      {changed("name = \"eight\"", "name = \"single-focus\""), "is there twice"},
      {changed("name = \"ball\"", "name = \"cube\""), "is there twice"},
      {changed("name = \"ball\"", "name = \"a,b\""), "without commas"},
      {changed("[[shape]]\nname = \"ball\"\nmodel = \"../ball.glb\"\nlabels = { de = \"Kugel\" }\n", ""),
       "a plan has 2 to 16 [[shape]], this one has 1"},
      {good + "[study]\nparticipants = 0\n", "participants"},
      {good + "[study]\npeople = 3\n", "people"},
      {good + "[observer]\nplacements = 2\n", "placements"},
      {good + "[observer]\ndepths_mm = [3, 1]\n", "ascending"},
      {good + "[observer]\ndepths_mm = []\n", "depths_mm"},
      {good + "[observer]\ncrest_mn = nan\n", "crest_mn"},
      {good + "[[candidate]]\nname = \"eight\"\nmethod = \"ellipse\"\n", "is there twice"},
      {good + "[run]\norder = \"random\"\n", "should be halves, alternate, williams or fixed"},
      {good + "[[method]]\nname = \"ellipse\"\n[run]\norder = \"halves\"\n", "for two methods, and the plan has 3"},
      {good + "[run]\nmasking = \"\"\n", "masking"},
      {good + "[run]\naxes = \"round\"\n", "should be steady or covariance"},
      {good + "[level]\nceiling = 1.5\n", "ceiling"},
      {good + "[level]\nmeasured_db = 100\n", "measured_db and measured_ceiling go together"},
      {good + "[level]\nmeasured_ceiling = 0.1\n", "measured_db and measured_ceiling go together"},
      {good + "[level]\nmeasured_db = nan\nmeasured_ceiling = 0.1\n", "measured_db"},
      {good + "[level]\nmeasured_db = -3\nmeasured_ceiling = 0.1\n", "measured_db"},
      {good + "[level]\nmeasured_db = 201\nmeasured_ceiling = 0.1\n", "measured_db"},
      {good + "[level]\nmeasured_db = \"100 dB\"\nmeasured_ceiling = 0.1\n", "measured_db"},
      {good + "[level]\nmeasured_db = 100\nmeasured_ceiling = 0\n", "measured_ceiling"},
      {good + "[level]\nright_ear_mm = [1, 2]\n", "right_ear_mm"},
      {good + "[level]\nright_ear_mm = [1, 2, 30000]\n", "10 m away"},
      {block + "kind = \"jump\"\n", "kind is 'jump'; it should be familiarise, free, practice, trial or rest"},
      {block + "repeats = 3\n", "kind"},
      {block + "kind = \"trial\"\nrepeats = 0\n", "repeats"},
      {block + "kind = \"trial\"\nshapes = [\"ball\"]\n", "needs at least 2 shapes"},
      {block + "kind = \"trial\"\nshapes = [\"ball\", \"ball\"]\n", "'ball' is there twice"},
      {block + "kind = \"practice\"\nshapes = [\"cone\"]\n", "'cone' is not a [[shape]]"},
      {block + "kind = \"free\"\nrepeats = 2\n", "repeats has no effect in a block 'free'"},
      {block + "kind = \"rest\"\nshapes = [\"ball\"]\n", "shapes has no effect"},
      {block + "kind = \"trial\"\nbetween_s = 2\n", "between_s"},
      {block + "kind = \"trial\"\nratings = 5\n", "ratings"},
      {block + "kind = \"rest\"\nfeedback = true\n", "feedback has no effect in a block 'rest'"},
      {block + "kind = \"practice\"\napart = true\n", "apart has no effect in a block 'practice'"},
      {block + "kind = \"trial\"\ntext = \"a\\u0007b\"\n", "one line"},
      {block + "kind = \"trial\"\ntext = \"\"\n", "not empty"},
      {block + "kind = \"trial\"\nrepeats = 1000\ntouch_s = 3600\n", "would touch for"},
      {good + "[texts.Klingon]\nend = \"Qapla\"\n", "is not a language"},
      {good + "[texts.en]\nfarewell = \"Bye\"\n", "farewell"},
      {"", "[[shape]]"},
      {"[[shape]\n", "plans/p.toml"},
  };
  for (const auto& one : cases) {
    const std::string fault = fault_of(one.text);
    EXPECT_CONTAINS(fault, one.fault);
    EXPECT_CONTAINS(fault, "plans/p.toml");
  }
}

TEST(PlanFile, DoubtsThatItMeasuresAnything) {
  const auto doubts = [](const std::string& blocks) { return doubts_of(parse_plan(good + blocks, "p.toml")); };
  EXPECT_TRUE(doubts("").empty());
  EXPECT_TRUE(doubts("[[block]]\nkind = \"trial\"\nonce = true\n[[block]]\nkind = \"trial\"\n").empty());
  const auto expect_one = [&](const std::string& blocks, const std::string& doubt) {
    ASSERT_EQ(doubts(blocks).size(), 1u) << blocks;
    EXPECT_CONTAINS(doubts(blocks)[0], doubt);
  };
  expect_one("[[block]]\nkind = \"practice\"\n", "no [[block]] of the kind 'trial'");
  expect_one("[[block]]\nkind = \"trial\"\nonce = true\n", "first method only");
  expect_one("[level]\nceiling = 0\n", "nothing sounds");
}

TEST(PlanFile, NeedsAFitOnlyForTheSimulation) {
  StudyPlan plan = parse_plan(changed("[fit]\nmethod = \"single-focus\"\naccuracy = 0.6\ntrials = 50\n", ""), "p.toml");
  EXPECT_REFUSED(refuse_without_fit(plan), "[fit] is missing");
}

TEST(PlanFile, NamesAMissingFile) {
  const std::filesystem::path folder = test::scratch_folder("plan");
  const auto fault = [&](const std::string& text) {
    test::write_text(folder / "p.toml", text);
    return test::error_of([&] { refuse_missing_files(read_plan(folder / "p.toml")); });
  };
  const std::string text = changed("../ball.glb", "ball.glb");
  EXPECT_CONTAINS(fault(text), "the model of 'cube' is missing");
  test::write_text(folder / "cube.glb", "x");
  test::write_text(folder / "ball.glb", "x");
  EXPECT_CONTAINS(fault(text), "the layout of 'eight'");
  test::write_text(folder / "own.toml", "x");
  EXPECT_EQ(fault(text), "");
  EXPECT_CONTAINS(fault(text + "[run]\nmasking = \"a.wav\"\n"), "masking sound is missing");
}

TEST(PlanFile, ThePlansOfTheAssetsAreComplete) {
  for (const char* name : {"paper.toml", "five-minutes.toml"}) {
    const StudyPlan plan = read_plan(test::source_file(std::string("assets/studies/") + name));
    EXPECT_EQ(plan.blocks[0].kind, BlockKind::familiarise) << name << ": shapes are shown";
    for (const PlanShape& shape : plan.shapes)
      EXPECT_TRUE(is_own_model(shape.model)) << name << ": a copy elsewhere finds it";
    refuse_without_fit(plan);
    EXPECT_EQ(plan.run.axes, touch::Axes::covariance) << name;
    EXPECT_EQ(plan.run.smoothing, touch::Smoothing::none) << name;
    EXPECT_EQ(plan.run.hysteresis, touch::Hysteresis::off) << name;
    EXPECT_FALSE(plan.run.predict) << name;
    EXPECT_LT(plan.level.ceiling, 0.1) << name;
  }
}

}  // namespace
}  // namespace palpa::study
