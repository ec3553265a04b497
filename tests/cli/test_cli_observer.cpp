// `palpa afferents` and `palpa study simulate` with a small finger and an array of few transducers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/files/sha256.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "geometry/files/ply.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/own_cache.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

class CliObserver : public testing::Test {
 protected:
  CliObserver() {
    const geometry::Mesh tip = transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); });
    geometry::write_ply(tip_, tip.positions, tip.triangles);
    write_small_plan(plan_, cube_, source_file("assets/prism.glb"));
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  const std::filesystem::path folder_ = scratch_folder("observer");
  const OwnCache cache_{folder_ / "cache"};
  const std::string tip_ = path("tip.ply"), plan_ = path("plan.toml"), cube_ = source_file("assets/cube.glb");
  const std::vector<std::string> afferents_{"afferents", "--scene",  cube_,          "--finger",   tip_, "--layout",
                                            "openmpd",   "--method", "single-focus", "--duration", "0.2"};
};

TEST_F(CliObserver, TimesAndMapOfAfferentsAreOfTheSameSpikes) {
  const Result result = succeeded(
      palpa_here(with(afferents_, {"--penetration", "1mm", "--crest", "200", "--json", "-", "--times",
                                   path("times.csv"), "--csv", path("sites.csv"), "--png", path("spikes.png")})));
  const json all = json::parse(result.out);
  EXPECT_EQ(all["spikes"].size(), 40u);
  double in_time = 0, on_map = 0, area = 0;
  for (const json& bin : all["spikes"])
    in_time += bin["pc"].get<double>();
  for (const json& site : all["sites"]) {
    area += site["area_cm2"].get<double>();
    on_map += site["rates_hz"]["pc"].get<double>() * site["area_cm2"].get<double>() * 25 * 0.2;
  }
  EXPECT_GT(in_time, 0);
  EXPECT_NEAR(in_time, on_map, 1e-6 * on_map);
  // At 200 Hz, no model of PC fires more than twice in a period for long.
  EXPECT_LE(in_time, 1.1 * 400 * 0.2 * area * 25);
  EXPECT_NEAR(all["afferents"]["pc"].get<double>(), 25 * area, 1e-6);
  EXPECT_NEAR(all["afferents"]["ra"].get<double>(), 140 * area, 1e-6);
  EXPECT_TRUE(read_text(path("times.csv")).starts_with("time_s,sa1,ra,pc\n0,"));
  EXPECT_TRUE(read_text(path("sites.csv")).starts_with("site,x,y,z,area_cm2,sa1_hz,ra_hz,pc_hz\n0,"));
  EXPECT_TRUE(std::filesystem::exists(path("spikes.png")));
}

/// A sample takes 0.2 ms, and a spike is at its end. The last sample's are counted, too.
TEST_F(CliObserver, SpikesAreInTheBinOfTheirSample) {
  struct Counts {
    std::vector<std::vector<double>> bins;  ///< rows of --times
    double in_time = 0, on_map = 0;         ///< of all classes together
  };
  const auto touch = [&](std::size_t samples, std::size_t bin) {
    const auto us = [](std::size_t n) { return std::to_string(200 * n) + "us"; };
    std::vector<std::string> line = afferents_;
    line.back() = us(samples);  // its duration
    const Result result =
        succeeded(palpa_here(with(line, {"--penetration", "1mm", "--crest", "200", "--bin", us(bin), "--json", "-",
                                         "--times", path("times.csv"), "--csv", path("sites.csv")})));
    const json afferents = json::parse(result.out)["afferents"];
    Counts counts{.bins = read_csv(path("times.csv"))};
    EXPECT_EQ(counts.bins.size(), (samples + bin - 1) / bin);
    const std::vector<std::vector<double>> sites = read_csv(path("sites.csv"));
    double area = 0;
    for (const std::vector<double>& site : sites)
      area += site[4];
    const double classes[]{afferents["sa1"], afferents["ra"], afferents["pc"]};
    for (std::size_t kind = 0; kind < 3; ++kind) {
      for (const std::vector<double>& row : counts.bins)
        counts.in_time += row[1 + kind];
      for (const std::vector<double>& site : sites)
        counts.on_map += site[5 + kind] * site[4] * classes[kind] / area * 2e-4 * static_cast<double>(samples);
    }
    EXPECT_NEAR(counts.in_time, counts.on_map, 1e-6 * counts.on_map) << samples << " samples, bins of " << bin;
    return counts;
  };
  const auto spikes = [](const std::vector<double>& row) { return row[1] + row[2] + row[3]; };
  double at_end = 0;
  for (const std::size_t samples : {198u, 199u, 200u}) {
    const Counts single = touch(samples, 1), five = touch(samples, 5);
    at_end += spikes(single.bins.back());
    for (std::size_t row = 0; row < five.bins.size(); ++row) {
      double sum = 0;
      for (std::size_t sample = 5 * row; sample < std::min(5 * row + 5, samples); ++sample)
        sum += spikes(single.bins[sample]);
      EXPECT_NEAR(spikes(five.bins[row]), sum, 1e-6 * single.on_map) << samples << " samples, row " << row;
    }
  }
  EXPECT_GT(at_end, 0);
}

TEST_F(CliObserver, TheLevelOfAfferentsIsThatOfASingleFocusOnTheCube) {
  const auto run = [&](const std::vector<std::string>& more) {
    const Result result = succeeded(palpa_here(with(afferents_, with({"--penetration", "3mm", "--json", "-"}, more))));
    return json::parse(result.out);
  };
  const json usual = run({}), louder = run({"--crest", "40"}), linear = run({"--linear"});
  EXPECT_EQ(usual["wave_m_s"], 8) << "TouchSim's";
  EXPECT_EQ(run({"--wave-speed", "3m/s"})["wave_m_s"], 3);
  EXPECT_NEAR(usual["crest_n"].get<double>(), 16e-3, 1e-9);
  EXPECT_NEAR(louder["crest_n"].get<double>(), 40e-3, 1e-9);
  EXPECT_EQ(linear["factor"], 1);
  EXPECT_NEAR(usual["factor"].get<double>() * linear["crest_n"].get<double>(), 16e-3, 1e-9);
}

TEST_F(CliObserver, PredictsAStudy) {
  const std::vector<std::string> line{"study", "simulate", plan_, "--finger", tip_};
  const Result result =
      succeeded(palpa_here(with(line, {"--json", path("a.json"), "--prediction", path("prediction.json"), "--html",
                                       path("a.html"), "--csv", path("a.csv")})));
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
  const json& variants = all["prediction"]["variants"];
  const auto rigid = std::ranges::find(variants, "no wave delays", [](const json& one) { return one["name"]; });
  ASSERT_NE(rigid, variants.end());
  EXPECT_NE((*rigid)["methods"], reference["methods"]) << "the skin's waves count";
  EXPECT_EQ(all["prediction"]["levels"].size(), 4u);
  const auto& levels = all["prediction"]["levels"];
  const auto level = std::ranges::find(levels, "16 mN", [](const json& one) { return one["name"]; });
  ASSERT_NE(level, levels.end()) << levels;
  EXPECT_NEAR((*level)["crest_n"].get<double>(), 16e-3, 1e-6);
  EXPECT_EQ(all["prediction"]["ranking"].size(), 3u);
  // Again, from the cache: the same bytes. People change only what is beside the prediction.
  write_text(path("cross-section.csv"), "actual,one,other\none,9,1\nother,4,6\n");
  const Result again = succeeded(palpa_here(with(
      line, {"--json", path("b.json"), "--prediction", path("again.json"), "--beside", path("cross-section.csv")})));
  EXPECT_EQ(read_text(path("again.json")), document);
  const json with_people = json::parse(read_text(path("b.json")));
  EXPECT_EQ(with_people["prediction"], all["prediction"]);
  EXPECT_EQ(with_people["beside"][0]["accuracy"], 0.75);
  EXPECT_EQ(all["beside"].size(), 0u);
}

TEST_F(CliObserver, RefusesPlansThatItCannotPredict) {
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
