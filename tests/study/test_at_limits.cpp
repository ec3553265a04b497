// Exactly at the limits of studies: the last value is taken, and the next one is refused or treated otherwise.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "study/analysis.hpp"
#include "study/files/counts_file.hpp"
#include "study/files/trial.hpp"
#include "study/plan/plan_file.hpp"
#include "study/statistics/rank_tests.hpp"
#include "study/statistics/wilcoxon.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

/// A table of so many shapes, whose names have so many letters, with one count in each cell.
CountsFile counts(std::size_t shapes, std::size_t letters = 2, const std::string& count = "1") {
  std::string heading = "actual", rows;
  for (std::size_t i = 0; i < shapes; ++i) {
    const std::string name = fmt::format("{:0{}}", i, letters);
    heading += "," + name;
    rows += name;
    for (std::size_t j = 0; j < shapes; ++j)
      rows += "," + count;
    rows += "\n";
  }
  return parse_counts(heading + "\n" + rows, "a.csv");
}

TEST(AtLimits, TablesOfCountsAreReadUpToTheirLimits) {
  EXPECT_EQ(counts(most_shapes).table.size(), most_shapes);
  EXPECT_REFUSED(counts(most_shapes + 1), "has 65 shapes");
  EXPECT_EQ(counts(2).table.size(), 2U);
  EXPECT_REFUSED(counts(1), "has 1 shapes");
  EXPECT_EQ(counts(2, most_name).table.shapes[0].size(), most_name);
  EXPECT_REFUSED(counts(2, most_name + 1), "is not a name");
  EXPECT_EQ(counts(2, 2, "1000000000").table.total(), 4'000'000'000U);
  EXPECT_REFUSED(counts(2, 2, "1000000001"), "is not a count");
}

/// A plan of so many shapes and methods, of which so many are candidates.
StudyPlan plan(std::size_t shapes, std::size_t methods, std::size_t candidates, const std::string& more = "") {
  std::string text;
  for (std::size_t i = 0; i < shapes; ++i)
    text += fmt::format("[[shape]]\nname = \"s{}\"\nmodel = \"a.glb\"\n", i);
  for (std::size_t i = 0; i < methods; ++i)
    text += fmt::format("[[{}]]\nname = \"m{}\"\nmethod = \"ellipse\"\n", i < candidates ? "candidate" : "method", i);
  return parse_plan(text + more, "p.toml");
}

TEST(AtLimits, PlansAreReadUpToTheirLimits) {
  EXPECT_EQ(plan(16, 1, 0).shapes.size(), 16U);
  EXPECT_REFUSED(plan(17, 1, 0), "this one has 17");
  EXPECT_EQ(plan(2, 1, 0).shapes.size(), 2U);
  EXPECT_REFUSED(plan(1, 1, 0), "this one has 1");
  EXPECT_EQ(plan(2, 64, 60).methods.size(), 4U);
  EXPECT_REFUSED(plan(2, 65, 60), "this one has 65");
  const auto depths = [](std::size_t count) {
    std::string list = "1";
    for (std::size_t i = 1; i < count; ++i)
      list += fmt::format(", {}", i + 1);
    return "[observer]\ndepths_mm = [" + list + "]\n";
  };
  EXPECT_EQ(plan(2, 1, 0, depths(32)).observer.depths_m.size(), 32U);
  EXPECT_REFUSED(plan(2, 1, 0, depths(33)), "1 to 32 numbers");
  EXPECT_EQ(plan(2, 1, 0, "[observer]\ndepths_mm = [100]\n").observer.depths_m[0], 0.1);
  EXPECT_REFUSED(plan(2, 1, 0, "[observer]\ndepths_mm = [100.00001]\n"), "up to 100");
  EXPECT_REFUSED(plan(2, 1, 0, "[observer]\ndepths_mm = [0]\n"), "above 0");
  EXPECT_REFUSED(plan(2, 1, 0, "[observer]\ndepths_mm = [2, 2]\n"), "ascending");
}

/// Each number of a plan: its table, its key, the least and the most, and what goes with it. Whole ones end in a step.
TEST(AtLimits, NumbersOfAPlanAreReadUpToTheirLimits) {
  const struct {
    const char *table, *key;
    double low, high;
    bool whole = false;
    const char* more = "";
  } numbers[]{{"[method]", "foci", 1, 64, true},
              {"[method]", "dwell_ms", 0.1, 1000},
              {"[method]", "modulation_hz", 1, 1000},
              {"[method]", "delta_mm", 0.01, 100},
              {"[observer]", "placements", 3, 64, true},
              {"[observer]", "lateral_mm", 0, 20},
              {"[observer]", "yaw_deg", 0, 90},
              {"[observer]", "crest_mn", 0.1, 1000},
              {"[study]", "participants", 1, 1000, true},
              {"[study]", "trials_per_shape", 1, 1000, true, "touch_s = 0.01"},
              {"[study]", "touch_s", 0.01, 600, false, "trials_per_shape = 1"},
              {"[study]", "least_trials", 0, 20, true},
              {"[run]", "seed", 0, 1e9, true},
              {"[run]", "deep_mm", 1, 200},
              {"[level]", "ceiling", 0, 1},
              {"[level]", "limit_db", 40, 160},
              {"[level]", "measured_db", 0, 200, false, "measured_ceiling = 0.1"},
              {"[level]", "measured_ceiling", 1e-3, 1, false, "measured_db = 100"},
              {"[[block]]\nkind = \"trial\"", "repeats", 1, 1000, true, "touch_s = 0.01"},
              {"[[block]]\nkind = \"trial\"", "touch_s", 0.01, 3600, false, "repeats = 1"},
              {"[[block]]\nkind = \"rest\"", "rest_s", 0.01, 3600}};
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const auto& [table, key, low, high, whole, more] : numbers) {
    const auto read = [&, table = std::string(table), key = key, more = more](double value) {
      const std::string line = fmt::format("{} = {}\n{}\n", key, value, more);
      const std::string method = "[[method]]\nname = \"m\"\nmethod = \"cross-section\"\n";
      parse_plan("[[shape]]\nname = \"a\"\nmodel = \"a.glb\"\n[[shape]]\nname = \"b\"\nmodel = \"a.glb\"\n" + method +
                     (table == "[method]" ? line : table + "\n" + line),
                 "p.toml");
    };
    for (const double last : {low, high})
      EXPECT_NO_THROW(read(last)) << key << " " << last;
    for (const double next :
         {whole ? low - 1 : std::nextafter(low, -inf), whole ? high + 1 : std::nextafter(high, inf)})
      EXPECT_CONTAINS(test::error_of([&] { read(next); }), key);
  }
}

TEST(AtLimits, TheObserverTouchesUpToItsLimit) {
  const auto observed = [](int depths) {
    std::string list;
    for (int i = 1; i <= depths; ++i)
      list += fmt::format("{}{}", i == 1 ? "" : ", ", i);
    return plan(10, 10, 4, "[observer]\nplacements = 20\ndepths_mm = [" + list + "]\n");
  };
  EXPECT_EQ(observed(25).touches(), most_planned_touches);
  EXPECT_REFUSED(observed(26), "would have to touch 52000 times");
}

TEST(AtLimits, APersonHasStepsAndHoursUpToTheirLimits) {
  // Two shapes are touched for as long as they say, and nothing else.
  const auto sounding = [](double seconds) {
    std::string blocks = "[study]\nleast_trials = 0\n";
    for (int half = 0; half < 8; ++half)
      blocks += fmt::format("[[block]]\nkind = \"free\"\nonce = true\ntouch_s = {}\n", half == 0 ? seconds : 3600.0);
    return blocks;
  };
  const double one = sounding_s(plan(2, 1, 0, sounding(3600))) / 8;
  EXPECT_NEAR(one, 3600, 1e-9);
  EXPECT_EQ(sounding_s(plan(2, 1, 0, sounding(3600))), most_sounding_s);
  EXPECT_REFUSED(plan(2, 1, 0, sounding(3600) + "[[block]]\nkind = \"free\"\nonce = true\ntouch_s = 0.01\n"), "hours");
}

TEST(AtLimits, DepthsOfATrialAreKeptUpToAMinute) {
  DepthCourse course;
  course.add(-std::numeric_limits<double>::min(), 1);
  EXPECT_TRUE(course.samples.empty());
  course.add(0, 1);
  EXPECT_EQ(course.samples.size(), 1U);
  course.add(std::nextafter(DepthCourse::bin_s, 0), 1);
  EXPECT_EQ(course.samples.size(), 1U);
  course.add(DepthCourse::bin_s, 1);
  EXPECT_EQ(course.samples.size(), 2U);
  constexpr double end_s = DepthCourse::bin_s * DepthCourse::most_bins;
  course.add(end_s, 1);
  EXPECT_EQ(course.samples.size(), 2U);
  course.add(std::nextafter(end_s, 0), 1);
  EXPECT_EQ(course.samples.size(), DepthCourse::most_bins);
}

TEST(AtLimits, PeopleWithATrialInEveryQuarterAreInTheCourseOfLearning) {
  // The answers of the second half are right.
  const auto learning = [](const std::vector<std::uint32_t>& trials) {
    Study study{.methods = {"m"}, .shapes = {"a", "b"}};
    for (const std::uint32_t count : trials) {
      Participant& person = study.participants.emplace_back();
      person.number = static_cast<std::uint32_t>(study.participants.size());
      for (std::uint32_t k = 0; k < count; ++k)
        person.trials.push_back({.method = 0, .shape = 0, .answer = k < count / 2 ? 1U : 0U});
    }
    return analyse(std::move(study), 0).courses[0].learning;
  };
  const std::vector<double> quarters{0, 0, 1, 1};
  EXPECT_EQ(learning({blocks}).block_accuracy, quarters);
  EXPECT_EQ(learning({blocks}).gains, std::vector<double>{1});
  EXPECT_TRUE(learning({blocks - 1}).block_accuracy.empty());
  EXPECT_TRUE(learning({blocks - 1}).gains.empty());
  EXPECT_EQ(learning({blocks - 1, blocks, 8 * blocks}).block_accuracy, quarters);
  EXPECT_EQ(learning({blocks - 1, blocks, 8 * blocks}).gains, (std::vector<double>{1, 1}));
}

TEST(AtLimits, TestsAreExactUpToTheirNumbersOfPeople) {
  std::vector<double> differences(most_exact_pairs);
  for (std::size_t i = 0; i < differences.size(); ++i)
    differences[i] = (i % 3 == 0 ? -1.0 : 1.0) * static_cast<double>(i + 1);
  EXPECT_TRUE(wilcoxon(differences).exact);
  differences.push_back(0);
  EXPECT_TRUE(wilcoxon(differences).exact) << "zeros do not count";
  differences.back() = 1000;
  EXPECT_FALSE(wilcoxon(differences).exact);
  std::vector<double> a(most_exact_people / 2), b = a;
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = static_cast<double>(2 * i);
    b[i] = static_cast<double>(2 * i + 1);
  }
  EXPECT_TRUE(rank_sum(a, b).exact);
  b.push_back(1000);
  EXPECT_FALSE(rank_sum(a, b).exact);
  // The interval of more pairs is that of the normal approximation, which goes on where the exact one ends.
  EXPECT_NEAR(static_cast<double>(signed_rank_index(most_exact_pairs + 1, 0.025)),
              static_cast<double>(signed_rank_index(most_exact_pairs, 0.025)), 100);
}

}  // namespace
}  // namespace palpa::study
