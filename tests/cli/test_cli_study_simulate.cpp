// `palpa study simulate` with a small finger, an array of few transducers and a small plan.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/sha256.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "geometry/files/ply.hpp"
#include "support/own_cache.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

class CliStudySimulate : public testing::Test {
 protected:
  CliStudySimulate() {
    const geometry::Mesh tip = transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); });
    geometry::write_ply(tip_, tip.positions, tip.triangles);
    write_small_plan(plan_, cube_, source_file("assets/prism.glb"));
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::filesystem::path folder_ = scratch_folder("study-simulate");
  const OwnCache cache_{folder_ / "cache"};
  const std::string tip_ = path("tip.ply"), plan_ = path("plan.toml"), cube_ = source_file("assets/cube.glb");
};

TEST_F(CliStudySimulate, PredictsAStudy) {
  const std::vector<std::string> line{"study", "simulate", plan_, "--finger", tip_};
  const Result result = palpa_here(with(line, {"--json", path("a.json"), "--prediction", path("prediction.json"),
                                               "--html", path("a.html"), "--csv", path("a.csv")}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("fitted to single-focus 0.600 (18 of 30 trials"), std::string::npos) << result.out;
  const json all = json::parse(read_text(path("a.json")));
  const std::string document = read_text(path("prediction.json"));
  // The hash is that of the file, which any program can check.
  EXPECT_EQ(all["sha256"], sha256(document));
  EXPECT_EQ(json::parse(document), all["prediction"]);
  const json& reference = all["prediction"]["variants"][0];
  EXPECT_EQ(reference["name"], "reference");
  EXPECT_NEAR(reference["methods"][0]["accuracy"].get<double>(), 0.6, 1e-4);
  ASSERT_EQ(reference["methods"].size(), 3u);
  for (const json& method : reference["methods"]) {
    EXPECT_GT(method["accuracy"].get<double>(), 0.4);
    EXPECT_LT(method["error"].get<double>(), 0.005);
  }
  EXPECT_EQ(all["prediction"]["levels"].size(), 4u);
  for (const json& level : all["prediction"]["levels"]) {
    const double crest = level["crest_n"];
    EXPECT_TRUE(level["name"] != "16 mN" || std::abs(crest - 16e-3) < 1e-6) << crest;
  }
  EXPECT_EQ(all["prediction"]["ranking"].size(), 3u);
  // Again, from the cache: the same bytes. People change only what is beside the prediction.
  write_text(path("cross-section.csv"), "actual,one,other\none,9,1\nother,4,6\n");
  const Result again = palpa_here(with(
      line, {"--json", path("b.json"), "--prediction", path("again.json"), "--beside", path("cross-section.csv")}));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(read_text(path("again.json")), document);
  const json with_people = json::parse(read_text(path("b.json")));
  EXPECT_EQ(with_people["prediction"], all["prediction"]);
  EXPECT_EQ(with_people["beside"][0]["accuracy"], 0.75);
  EXPECT_EQ(all["beside"].size(), 0u);
}

TEST_F(CliStudySimulate, BadInputIsOneLine) {
  write_text(path("bad.toml"), read_text(plan_) + "[observers]\n");
  write_small_plan(path("missing.toml"), cube_, "missing.glb");
  const std::string whole = read_text(plan_);
  write_text(path("no-fit.toml"), whole.substr(0, whole.find("[fit]")));
  std::vector<Told> lines{{{}, "the plan is missing: give the TOML file of a study"},
                          {{path("none.toml")}, "none.toml", 4},
                          {{path("bad.toml")}, "observers", 4},
                          {{path("missing.toml"), "--finger", tip_}, "missing.glb", 4},
                          {{path("no-fit.toml"), "--finger", tip_}, "[fit] is missing", 4},
                          {{plan_, "--finger", tip_, "--beside", path("none.csv")}, "none.csv", 4},
                          {{plan_, "--finger", cube_}, "cube.glb", 4}};
  // Palpa's own plans are good: the fault is the finger.
  for (const char* own : {"assets/studies/paper.toml", "assets/studies/five-minutes.toml"})
    lines.push_back({{source_file(own), "--finger", path("none.ply")}, "none.ply", 4});
  expect_refused({"study", "simulate"}, lines);
}

}  // namespace
}  // namespace palpa::test
