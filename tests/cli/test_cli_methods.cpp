// --method, --modulation, --spectrum and --tune of the commands that play a touch.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/cube_touch.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/report.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
constexpr double pi = std::numbers::pi;

json report(const std::vector<std::string>& more) {
  return report_of(cube_touch(more));
}

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items())
    names.push_back(key);
  return names;
}

std::uint32_t sum_of(const json& counts) {
  const auto numbers = counts.get<std::vector<std::uint32_t>>();
  return std::accumulate(numbers.begin(), numbers.end(), 0u);
}

TEST(CliMethods, EachPrintsItsFociAndOrder) {
  const json cross = report({}), ellipse = report({"--method", "ellipse"});
  const json single = report({"--method", "single-focus"}), multi = report({"--method", "multi-focus"});
  for (const json* other : {&ellipse, &single, &multi}) {
    EXPECT_EQ((*other)["contacts"], cross["contacts"]);
    EXPECT_EQ(keys(*other), keys(cross)) << "no key that nobody asked for";
    EXPECT_EQ(keys((*other)["fingers"][0]), keys(cross["fingers"][0]));
    EXPECT_EQ((*other)["fingers"][0]["centroid_m"], cross["fingers"][0]["centroid_m"]);
  }
  EXPECT_EQ(ellipse["schedule"], cross["schedule"]);
  EXPECT_EQ(single["schedule"]["order"], json::parse("[0]"));
  EXPECT_EQ(multi["schedule"]["order"], json::parse("[[0,1,2,3,4,5,6,7,8,9]]"));
  EXPECT_EQ(multi["fingers"][0]["foci_m"], cross["fingers"][0]["foci_m"]);
  EXPECT_EQ(single["fingers"][0]["foci_m"], json::array({cross["fingers"][0]["centroid_m"]}));
  EXPECT_EQ(single["fingers"][0]["focus_points"], json::array({cross["contacts"]["count"]}));
  ASSERT_EQ(ellipse["fingers"][0]["foci_m"].size(), 10u);
  EXPECT_EQ(sum_of(ellipse["fingers"][0]["focus_points"]), cross["contacts"]["count"]);
}

TEST(CliMethods, TheSpectrumComesWhereItIsAskedFor) {
  json finger = report({"--spectrum"})["fingers"][0];
  const json spectrum = finger["spectrum"];
  finger.erase("spectrum");
  EXPECT_EQ(finger, report({})["fingers"][0]);
  ASSERT_EQ(spectrum["lines"].size(), 15u);
  EXPECT_DOUBLE_EQ(spectrum["period_s"].get<double>(), 0.015);
  EXPECT_NEAR(spectrum["lines"][2]["frequency_hz"].get<double>(), 200, 1e-9);
  EXPECT_EQ(spectrum["skin_m"], finger["foci_m"][0]);
  // What a wider spot blurs, a narrow one does not.
  EXPECT_GT(report({"--spectrum", "--spot", "2mm"})["fingers"][0]["spectrum"]["variance"], spectrum["variance"]);
  const std::string table = palpa_here(cube_touch({"--spectrum"})).out;
  EXPECT_CONTAINS(table, "    200.0  ");
  EXPECT_CONTAINS(table,
                  "  frequency  pressure   phase  around    felt\n"
                  "         Hz    x mean     rad  x mean  x mean\n");
  const json still = report({"--spectrum", "--method", "single-focus", "--dwell", "0.5ms"})["fingers"][0]["spectrum"];
  ASSERT_EQ(still["lines"].size(), 1u);
  EXPECT_NEAR(still["lines"][0]["amplitude"].get<double>(), std::sin(0.1 * pi) / (0.1 * pi), 1e-12);
}

TEST(CliMethods, TheSameTouchIsFeltOtherwiseOnEveryArray) {
  const auto spectrum = [](const std::vector<std::string>& more) {
    return report(with({"--spectrum"}, more))["fingers"][0]["spectrum"];
  };
  const json spots = spectrum({}), paper = spectrum({"--layout", "paper"}), board = spectrum({"--layout", "openmpd"});
  EXPECT_EQ(spots["field"], "spot");
  EXPECT_NEAR(spots["felt_share"].get<double>(), 0.49, 0.006);
  EXPECT_EQ(paper["field"], "array");
  EXPECT_NEAR(paper["felt_share"].get<double>(), 0.53, 0.006);
  EXPECT_NEAR(board["felt_share"].get<double>(), 0.66, 0.006);
  EXPECT_LT(board["flutter_share"], spots["flutter_share"]);
  // Its own sound counts, unless spots are asked for.
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--temperature", "0"}, {"--directivity", "piston"}})
    EXPECT_NE(spectrum(with(options, {"--layout", "paper"}))["felt_share"], paper["felt_share"]) << options[0];
  EXPECT_EQ(spectrum({"--layout", "openmpd", "--spot", "3.8mm"}), spots);
  EXPECT_EQ(report({"--tune", "--layout", "openmpd"})["fingers"][0]["tune"]["field"], "array");
}

TEST(CliMethods, ARunSaysWhatItsStridesFollow) {
  const auto tune = [](const std::vector<std::string>& more) {
    const std::vector<std::string> line{
        "run",     "--scene", asset_file("cube.glb"), "--backend", "cpu", "--frames", "2", "--layout", "openmpd",
        "--stats", "json"};
    const Result result = succeeded(palpa_here(with(with(line, small_frames()), more)));
    return json::parse(result.out).value("tune", json());
  };
  const json spots{{"field", "spot"}, {"fields", 0}};
  EXPECT_TRUE(tune({}).is_null());
  EXPECT_EQ(tune({"--tune"})["field"], "array");
  EXPECT_EQ(tune({"--tune", "--every-frame"}), spots);
  EXPECT_EQ(tune({"--tune", "--spot", "5mm"}), spots);
}

TEST(CliMethods, TuningSaysWhatItChoseAndGivesTheFingerItsOwnSchedule) {
  const json before = report({"--spectrum", "--stride", "1"});
  const json tuned = report({"--spectrum", "--stride", "1", "--tune"});
  const json &finger = tuned["fingers"][0], &choice = finger["tune"];
  const auto foci = choice["foci"].get<std::size_t>();
  EXPECT_GE(foci, 10u);
  EXPECT_EQ(finger["foci_m"].size(), foci);
  EXPECT_EQ(finger["focus_points"].size(), foci);
  EXPECT_EQ(finger["schedule"]["order"].size(), foci);
  EXPECT_EQ(finger["schedule"]["order"][1], choice["stride"]);
  EXPECT_EQ(finger["schedule"]["dwell_s"], 0.0015);
  EXPECT_EQ(tuned["schedule"], before["schedule"]) << "what the others play";
  EXPECT_GT(choice["felt_share"], 1.05 * choice["felt_share_before"].get<double>());
  EXPECT_LT(choice["flutter_share"], choice["flutter_share_before"]);
  // On the finger itself, too, not only on a ring of its perimeter.
  EXPECT_GT(finger["spectrum"]["felt_share"], before["fingers"][0]["spectrum"]["felt_share"]);
  EXPECT_EQ(sum_of(finger["focus_points"]), tuned["contacts"]["count"]);
  EXPECT_CONTAINS(palpa_here(cube_touch({"--stride", "1", "--tune"})).out, "tuned to");
  const json range = report({"--tune", "--tune-shortest", "0.5ms", "--tune-longest", "1ms"});
  const double dwell = range["fingers"][0]["schedule"]["dwell_s"];
  EXPECT_TRUE(dwell >= 0.5e-3 && dwell <= 1e-3) << dwell;
  EXPECT_FALSE(report({"--tune", "--method", "multi-focus"})["fingers"][0].contains("tune"));
}

/// The file with the drives of the finger on the cube.
std::filesystem::path drives_by(const std::vector<std::string>& options) {
  static const std::filesystem::path folder = scratch_folder("methods");
  const std::filesystem::path file = folder / "drives.bin";
  succeeded(palpa_here(with(with({"export", "--scene", asset_file("cube.glb"), "--frames", "20", "--backend", "cpu",
                                  "--drives", file, "--quiet"},
                                 small_frames()),
                            options)));
  return file;
}

TEST(CliMethods, EveryMethodIsPlayedWithItsModulation) {
  // At slots' midpoints, the modulation of the pressure has the gains 0, sin 18 deg, sin 36 deg ... 1.
  const double weakest = std::sin(pi / 10);
  const std::pair<std::vector<std::string>, double> methods[]{
      {{"--method", "single-focus"}, weakest},
      {{"--method", "single-focus", "--modulation", "amplitude-sine"}, weakest * weakest},
      {{"--method", "multi-focus"}, weakest},
      {{"--method", "ellipse"}, 1}};
  for (const auto& [options, expected] : methods) {
    float least = 1, most = 0;
    for (const RecordedDrive& recorded : read_to_silence(drives_by(with(options, {"--tune"}))).drives) {
      const float loud = loudest(recorded.drive);
      most = std::max(most, loud);
      if (loud > 1e-3F) least = std::min(least, loud);
    }
    EXPECT_GT(most, 0.98F) << testing::PrintToString(options);
    EXPECT_NEAR(least, expected, 0.02) << testing::PrintToString(options);
  }
}

TEST(CliMethods, FociThatSoundTogetherAreSolvedUnlessToldOtherwise) {
  const auto drives = [](const std::vector<std::string>& solver) {
    return read_text(drives_by(with({"--method", "multi-focus"}, solver)));
  };
  const std::string left_out = drives({});
  EXPECT_TRUE(left_out == drives({"--solver", "gs-pat"}));
  EXPECT_FALSE(left_out == drives({"--solver", "naive"}));
}

}  // namespace
}  // namespace palpa::test
