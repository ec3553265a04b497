// The whole analysis of ten participants whose statistics are known, of studies with more methods, and of the smallest.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "study/analysis.hpp"
#include "study/files/study_folder.hpp"
#include "study/report/reports.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"
#include "support/time_limits.hpp"

namespace palpa::study {
namespace {

/// A study of participants with these correct answers of 40, by method, in the order of `turns`.
Study study_of(const std::vector<std::vector<std::uint32_t>>& correct, const std::vector<std::string>& methods) {
  Study study{.methods = methods, .shapes = test::study_shapes};
  for (std::uint32_t p = 0; p < correct.size(); ++p) {
    Participant& participant = study.participants.emplace_back();
    participant.number = p + 1;
    // The first half begins with the first method.
    for (std::uint32_t turn = 0; turn < methods.size(); ++turn) {
      const std::uint32_t m = p < correct.size() / 2 ? turn : static_cast<std::uint32_t>(methods.size()) - 1 - turn;
      for (std::uint32_t k = 0; k < 40; ++k) {
        const std::uint32_t shape = k % 4, answer = k * 7 % 40 < correct[p][m] ? shape : (shape + 1) % 4;
        participant.trials.push_back({m, shape, answer, 1.0 + 0.1 * m});
      }
    }
  }
  return study;
}

Study ten() {
  std::vector<std::vector<std::uint32_t>> correct;
  for (int i = 0; i < 10; ++i)
    correct.push_back({test::ten_single[i], test::ten_cross[i]});
  return study_of(correct, {"single-focus", "cross-section"});
}

TEST(StudyAnalysis, OfTenKnownParticipants) {
  const Analysis analysis = analyse(ten(), 0);
  ASSERT_EQ(analysis.results.methods.size(), 2u);
  EXPECT_NEAR(analysis.results.methods[0].mean_accuracy, 0.390, 1e-15);
  EXPECT_NEAR(analysis.results.methods[1].mean_accuracy, 0.6525, 1e-15);
  EXPECT_EQ(analysis.results.methods[0].pooled.table.correct(), 156u);
  EXPECT_EQ(analysis.results.methods[1].pooled.table.correct(), 261u);
  ASSERT_EQ(analysis.between.pairs.size(), 1u);
  const MethodPair& pair = analysis.between.pairs[0];
  EXPECT_EQ(pair.drop.two_sided, 2.0 / 1024);
  EXPECT_EQ(pair.drop.positive, 55);
  EXPECT_NEAR(pair.drop.normal, 0.004725697734, 1e-11) << "two pairs of ties that doubles of accuracies would break";
  EXPECT_NEAR(pair.mean, 0.2625, 1e-15);
  EXPECT_EQ(pair.hodges_lehmann.estimate, 0.25);
  EXPECT_NEAR(pair.pearson->r, 0.866851219, 1e-9);
  EXPECT_NEAR(pair.spearman->r, 0.887195122, 1e-9);
  EXPECT_FALSE(pair.holm || analysis.between.friedman) << "only above two methods";
  EXPECT_EQ(pair.order.a_first.size(), 5u);
  EXPECT_EQ(pair.order.b_first.size(), 5u);
  ASSERT_TRUE(pair.order.test);
  EXPECT_GT(pair.order.test->p, 0.1);
}

TEST(StudyAnalysis, OrderLearningAndTimes) {
  const Analysis analysis = analyse(ten(), 0);
  EXPECT_EQ(analysis.results.people[0].turn, 1u);
  EXPECT_EQ(analysis.results.people[1].turn, 2u);
  EXPECT_EQ(analysis.results.people[10].turn, 2u) << "the sixth participant began with the other method";
  const MethodCourse& course = analysis.courses[1];
  ASSERT_EQ(course.learning.block_accuracy.size(), blocks);
  EXPECT_EQ(course.learning.gains.size(), 10u);
  EXPECT_NEAR(course.times.median_s.value(), 1.1, 1e-12);
  EXPECT_TRUE(course.depths.empty());
}

TEST(StudyAnalysis, LearningShowsAsAGain) {
  Study study = study_of({{40}, {40}, {40}, {40}, {40}, {40}}, {"m"});
  for (Participant& participant : study.participants) {
    for (std::size_t k = 0; k < 20; ++k)
      participant.trials[k].answer = (participant.trials[k].shape + 1) % 4;
  }
  const Learning learning = analyse(std::move(study), 0).courses[0].learning;
  EXPECT_EQ(learning.block_accuracy, (std::vector<double>{0, 0, 1, 1}));
  EXPECT_EQ(learning.gains, std::vector<double>(6, 1.0));
  EXPECT_EQ(learning.test.two_sided, 2.0 / 64);
}

TEST(StudyAnalysis, ThreeMethodsHaveFriedmanAndHolm) {
  const Analysis analysis = analyse(
      study_of({{10, 20, 30}, {12, 20, 32}, {8, 18, 31}, {11, 25, 27}, {9, 16, 33}, {14, 21, 35}}, {"a", "b", "c"}), 0);
  ASSERT_TRUE(analysis.between.friedman);
  EXPECT_NEAR(analysis.between.friedman->chi_square, 12, 1e-12);
  ASSERT_EQ(analysis.between.pairs.size(), 3u);
  for (const MethodPair& pair : analysis.between.pairs) {
    EXPECT_EQ(pair.drop.two_sided, 2.0 / 64);
    EXPECT_NEAR(pair.holm.value(), 6.0 / 64, 1e-15);
  }
}

TEST(StudyAnalysis, OneParticipantWithOneMethodHasNoTests) {
  const Analysis analysis = analyse(study_of({{20}}, {"m"}), 0);
  EXPECT_TRUE(analysis.between.pairs.empty());
  EXPECT_FALSE(analysis.results.methods[0].deviation || analysis.results.methods[0].t);
  EXPECT_EQ(analysis.results.methods[0].mean_accuracy, 0.5);
}

TEST(StudyAnalysis, ParticipantsWithOneOfTheMethodsAreNotPaired) {
  Study study = ten();
  std::erase_if(study.participants[3].trials, [](const Trial& trial) { return trial.method == 1; });
  const Analysis analysis = analyse(std::move(study), 0);
  EXPECT_EQ(analysis.between.pairs[0].people.size(), 9u);
  EXPECT_EQ(analysis.results.methods[0].accuracies.size(), 10u);
}

TEST(StudyAnalysis, ParticipantsWithTooFewTrialsAreLeftOutOfComparisons) {
  Study study = ten();
  study.participants[3].trials.resize(47);  // 40 with one method and 7 with the other
  study.least_trials = 30;
  const Analysis analysis = analyse(std::move(study), 0);
  const MethodPair& pair = analysis.between.pairs[0];
  EXPECT_EQ(pair.excluded, std::vector<std::size_t>{3});
  EXPECT_EQ(pair.people.size(), 9u);
  EXPECT_EQ(pair.drop.two_sided, 2.0 / 512);
  EXPECT_EQ(pair.with_excluded.value().nonzero, 10u);
  EXPECT_EQ(pair.order.a_first.size(), 4u);
  EXPECT_EQ(analysis.results.methods[1].accuracies.size(), 10u) << "the answers stay in the tables";
  const std::string text = analysis_text(analysis), html = analysis_html(analysis);
  for (const std::string& report : {text, html}) {
    EXPECT_CONTAINS(report, "at least 30 trials with each method: participant 4 (40 and 7)");
    EXPECT_CONTAINS(report, "with them: mean ");
  }
  EXPECT_CONTAINS(analysis_json(analysis), "\"excluded\": [4]");
  // One who did not come to the other method.
  Study half = ten();
  std::erase_if(half.participants[5].trials, [](const Trial& trial) { return trial.method == 1; });
  half.least_trials = 30;
  const Analysis without = analyse(std::move(half), 0);
  EXPECT_EQ(without.between.pairs[0].excluded, std::vector<std::size_t>{5});
  EXPECT_FALSE(without.between.pairs[0].with_excluded) << "there is no difference";
  EXPECT_CONTAINS(analysis_text(without), "at least 30 trials with each method: participant 6 (40 and 0)");
  // Nobody has enough.
  Study few = ten();
  few.least_trials = 41;
  const Analysis none = analyse(std::move(few), 0);
  EXPECT_EQ(none.between.pairs[0].excluded.size(), 10u);
  EXPECT_EQ(none.between.pairs[0].with_excluded.value().two_sided, 2.0 / 1024);
  EXPECT_CONTAINS(analysis_text(none), "nobody has enough trials");
  EXPECT_CONTAINS(analysis_html(none), "Nobody has enough trials");
}

TEST(StudyAnalysis, CountsTrialsThatWereBrokenOff) {
  const std::filesystem::path folder = test::scratch_folder("voids");
  std::string text = test::events_text("single-focus", 18) + "900\t3\ttrial\tsingle-focus\tcube\tn/a\tn/a\tvoid\n";
  text += "950\t10\tfamiliarise\tsingle-focus\tcube\tno\t1\tanswered\n";
  test::write_events(test::events_place(folder, 1), text, "{\"PalpaStudyVersion\": 1, \"LeastTrials\": 30}");
  test::write_events(test::events_place(folder, 1, 2), test::events_text("cross-section", 28));
  const Analysis analysis = analyse(read_study(std::vector<std::string>{folder.string()}), 0);
  EXPECT_EQ(analysis.study.least_trials, 30u);
  EXPECT_EQ(analysis.results.methods[0].voids, 1u);
  EXPECT_EQ(analysis.results.methods[1].voids, 0u);
  EXPECT_CONTAINS(analysis_text(analysis), "; 1 trial void\n");
  EXPECT_CONTAINS(analysis_text(analysis), "participant 1 felt nothing in 1 of 1 familiarisation");
  EXPECT_CONTAINS(analysis_csv(analysis), ",void\n");
  EXPECT_EQ(analysis.results.methods[0].void_shapes, (std::vector<std::uint32_t>{1, 0, 0, 0}));
  EXPECT_CONTAINS(analysis_text(analysis), "\n  void by shape, which is not chance: cube 1\n");
  EXPECT_CONTAINS(analysis_json(analysis), "\"void\": 1,\n");
  EXPECT_CONTAINS(analysis_json(analysis), "\"void_by_shape\": [1, 0, 0, 0]");
  EXPECT_CONTAINS(analysis_html(analysis), "single-focus: void trials by shape, which is not chance: cube 1");
}

TEST(StudyAnalysis, TrialsThatWereBrokenOffAreTheMethodsOwn) {
  Study study = study_of({{20, 30}, {20, 30}}, {"single-focus", "cross-section"});
  study.participants[0].voids = {3, 5};
  study.participants[1].voids = {7, 11};
  std::erase_if(study.participants[1].trials, [](const Trial& trial) { return trial.method == 0; });
  std::vector<std::uint32_t> voids;
  for (const PersonResult& result : analyse(std::move(study), 0).results.people)
    voids.push_back(result.voids);
  EXPECT_EQ(voids, (std::vector<std::uint32_t>{3, 5, 11}));
}

TEST(StudyAnalysis, DepthsAreMeansOverPeopleInEachBin) {
  Study study = study_of({{20, 30}, {20, 30}, {20, 30}}, {"single-focus", "cross-section"});
  for (const double deep_m : {1e-3, 3e-3}) {
    auto& depths = study.participants[deep_m > 2e-3 ? 2 : 0].depths;
    depths.resize(2 * study.shapes.size());
    DepthCourse& course = depths[study.shapes.size() + 1];  // cross-section, the second shape
    course.add(0.1, deep_m);
    course.add(0.2, deep_m + 2e-3);
    if (deep_m > 2e-3) course.add(0.6, 7e-3);
  }
  const Analysis analysis = analyse(std::move(study), 0);
  const MeanDepth& mean = analysis.courses[1].depths[1];
  EXPECT_EQ(mean.people, 2u);
  ASSERT_EQ(mean.depth_m.size(), 3u);
  EXPECT_NEAR(mean.depth_m[0].value(), 3e-3, 1e-12);
  EXPECT_FALSE(mean.depth_m[1]);
  EXPECT_NEAR(mean.depth_m[2].value(), 7e-3, 1e-12);
  EXPECT_TRUE(analysis.courses[1].depths[0].depth_m.empty());
  const auto methods = nlohmann::json::parse(analysis_json(analysis))["methods"];
  const auto& depth = methods[1]["depth"];
  EXPECT_EQ(depth["bin_s"], 0.25);
  EXPECT_EQ(depth[test::study_shapes[1]], nlohmann::json::parse("[0.003, null, 0.007]"));
  EXPECT_EQ(depth[test::study_shapes[0]], nlohmann::json::array());
  EXPECT_CONTAINS(analysis_html(analysis), "mean depth of the finger below the top of the object");
}

TEST(StudyAnalysis, OfAHundredTakesAboutASecond) {
  std::vector<std::vector<std::uint32_t>> correct;
  for (std::uint32_t i = 0; i < 100; ++i)
    correct.push_back({10 + i * 7 % 17, 14 + i * 5 % 21});
  Study study = study_of(correct, {"single-focus", "cross-section"});
  const double begin_s = test::processor_s();
  const Analysis analysis = analyse(std::move(study), 0);
  if (!test::instrumented()) {
    EXPECT_LT(test::processor_s() - begin_s, test::slowest);
  }
  EXPECT_EQ(analysis.results.people.size(), 200u);
}

}  // namespace
}  // namespace palpa::study
