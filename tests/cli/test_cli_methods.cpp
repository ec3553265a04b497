// --method, --modulation, --spectrum and --tune in the real program.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "session/links/record_link.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

std::vector<std::string> touch(const std::vector<std::string>& more, const std::string& penetration = "3mm") {
  std::vector<std::string> arguments{"touch",         "--scene",   asset("cube.glb"), "--points", asset("finger.ply"),
                                     "--penetration", penetration, "--backend",       "cpu"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

json document(std::vector<std::string> more, const std::string& penetration = "3mm") {
  more.insert(more.end(), {"--json", "-"});
  const Result result = palpa_here(touch(more, penetration));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& [key, value] : object.items())
    names.push_back(key);
  return names;
}

TEST(CliMethods, EachPrintsItsFociAndOrder) {
  const json cross = document({}), ellipse = document({"--method", "ellipse"});
  const json single = document({"--method", "single-focus"}), multi = document({"--method", "multi-focus"});
  EXPECT_EQ(document({"--method", "cross-section"})["fingers"], cross["fingers"]);
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
  const auto counts = ellipse["fingers"][0]["focus_points"].get<std::vector<std::uint32_t>>();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), cross["contacts"]["count"]);
}

TEST(CliMethods, AnEllipseTakesEqualAnglesOrArcs) {
  const json angle = document({"--method", "ellipse"}), arc = document({"--method", "ellipse", "--spacing", "arc"});
  EXPECT_NE(angle["fingers"][0]["foci_m"], arc["fingers"][0]["foci_m"]);
  EXPECT_EQ(arc["fingers"][0]["foci_m"].size(), 10u);
}

TEST(CliMethods, UnknownOnesAreRefused) {
  expect_failure(palpa_here(touch({"--method", "loud"})), 2, "multi-focus");
  expect_failure(palpa_here(touch({"--modulation", "square"})), 2, "pressure-sine");
  expect_failure(palpa_here(touch({"--tune", "--tune-shortest", "1ms"})), 2, "--tune-longest");
  expect_failure(palpa_here(touch({"--tune-shortest", "1ms", "--tune-longest", "2ms"})), 2, "--tune");
  expect_failure(palpa_here(touch({"--tune", "--tune-shortest", "2ms", "--tune-longest", "1ms"})), 2, "tenth");
}

TEST(CliMethods, TheSpectrumComesWhereItIsAskedFor) {
  const json plain = document({}), with = document({"--spectrum"});
  json finger = with["fingers"][0];
  const json spectrum = finger["spectrum"];
  finger.erase("spectrum");
  EXPECT_EQ(finger, plain["fingers"][0]);
  ASSERT_EQ(spectrum["lines"].size(), 15u);
  EXPECT_DOUBLE_EQ(spectrum["period_s"].get<double>(), 0.015);
  EXPECT_NEAR(spectrum["lines"][2]["frequency_hz"].get<double>(), 200, 1e-9);
  EXPECT_EQ(spectrum["skin_m"], finger["foci_m"][0]);
  double length = 0;
  for (std::size_t n = 0; n < 10; ++n) {
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double d = finger["foci_m"][n][i].get<double>() - finger["foci_m"][(n + 1) % 10][i].get<double>();
      square += d * d;
    }
    length += std::sqrt(square);
  }
  EXPECT_NEAR(spectrum["perimeter_m"].get<double>(), length * (M_PI / 10) / std::sin(M_PI / 10), 1e-8);
  // What a wider spot blurs, a narrow one does not.
  EXPECT_GT(document({"--spectrum", "--spot", "2mm"})["fingers"][0]["spectrum"]["variance"], spectrum["variance"]);
  const Result table = palpa(touch({"--spectrum"}));
  EXPECT_NE(table.out.find("    200.0  "), std::string::npos) << table.out;
  EXPECT_NE(table.out.find("  frequency  pressure   phase  around    felt\n"
                           "         Hz    x mean     rad  x mean  x mean\n"),
            std::string::npos)
      << table.out;
  const json still = document({"--spectrum", "--method", "single-focus", "--dwell", "0.5ms"})["fingers"][0]["spectrum"];
  ASSERT_EQ(still["lines"].size(), 1u);
  EXPECT_NEAR(still["lines"][0]["amplitude"].get<double>(), std::sin(0.1 * M_PI) / (0.1 * M_PI), 1e-12);
}

TEST(CliMethods, TheSameTouchIsFeltOtherwiseOnEveryArray) {
  const auto spectrum = [](const std::vector<std::string>& more) {
    return document(with({"--spectrum"}, more))["fingers"][0]["spectrum"];
  };
  const json spots = spectrum({}), paper = spectrum({"--layout", "paper"}), board = spectrum({"--layout", "openmpd"});
  EXPECT_EQ(spots["field"], "spot");
  EXPECT_NEAR(spots["felt_share"].get<double>(), 0.49, 0.006);
  EXPECT_EQ(paper["field"], "array");
  EXPECT_NEAR(paper["felt_share"].get<double>(), 0.53, 0.006);
  EXPECT_EQ(board["field"], "array");
  EXPECT_NEAR(board["felt_share"].get<double>(), 0.66, 0.006);
  EXPECT_LT(board["flutter_share"], spots["flutter_share"]);
  // Its own sound counts.
  EXPECT_NE(spectrum({"--layout", "paper", "--temperature", "0"})["felt_share"], paper["felt_share"]);
  EXPECT_NE(spectrum({"--layout", "paper", "--directivity", "piston"})["felt_share"], paper["felt_share"]);
  // A spot takes the field's place.
  const json as_spots = spectrum({"--layout", "openmpd", "--spot", "3.8mm"});
  EXPECT_EQ(as_spots, spots);
  // Where it would be tuned as spots it is not.
  const std::vector<std::string> sixteen{"--tune", "--foci", "16"};
  const json tuned = document(sixteen)["fingers"][0]["tune"];
  const json kept = document(with(sixteen, {"--layout", "openmpd"}))["fingers"][0]["tune"];
  EXPECT_EQ(tuned["field"], "spot");
  EXPECT_NE(tuned["foci"], 16);
  EXPECT_EQ(kept["field"], "array");
  EXPECT_EQ(kept["foci"], 16);
  EXPECT_EQ(kept["stride"], 5);
}

TEST(CliMethods, ARunSaysWhatItsStridesFollow) {
  const auto tune = [](const std::vector<std::string>& more) {
    const std::vector<std::string> line{"run", "--scene",  asset("cube.glb"), "--backend", "cpu", "--frames",
                                        "2",   "--layout", "openmpd",         "--stats",   "json"};
    const Result result = palpa(with(with(line, small_frames()), more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out).value("tune", json());
  };
  const json spots{{"field", "spot"}, {"fields", 0}};
  side_by_side({[&] { EXPECT_TRUE(tune({}).is_null()); }, [&] { EXPECT_EQ(tune({"--tune"})["field"], "array"); },
                [&] {
                  EXPECT_EQ(tune({"--tune", "--every-frame"}), spots);
                },
                [&] {
                  EXPECT_EQ(tune({"--tune", "--spot", "5mm"}), spots);
                }});
}

TEST(CliMethods, ASpotThatNothingUsesIsRefused) {
  expect_failure(palpa_here(touch({"--spot", "2mm"})), 2, "--spot goes with --spectrum or --tune");
  EXPECT_EQ(palpa_here(touch({"--spot", "2mm", "--tune"})).exit_code, 0);
  const std::vector<std::string> run{"run",      "--scene", asset("cube.glb"), "--backend", "cpu",
                                     "--frames", "2",       "--spot",          "2mm",       "--quiet"};
  expect_failure(palpa_here(run), 2, "--spot goes with --tune");
  EXPECT_EQ(palpa(with(with(run, {"--tune"}), small_frames())).exit_code, 0);
}

TEST(CliMethods, TuningSaysWhatItChoseAndGivesTheFingerItsOwnSchedule) {
  const json before = document({"--spectrum", "--stride", "1"});
  const json tuned = document({"--spectrum", "--stride", "1", "--tune"});
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
  const auto counts = finger["focus_points"].get<std::vector<std::uint32_t>>();
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), 0u), tuned["contacts"]["count"]);
  const Result said = palpa(touch({"--stride", "1", "--tune"}));
  EXPECT_NE(said.out.find("tuned to"), std::string::npos) << said.out;
  const json range = document({"--tune", "--tune-shortest", "0.5ms", "--tune-longest", "1ms"});
  const double dwell = range["fingers"][0]["schedule"]["dwell_s"];
  EXPECT_TRUE(dwell >= 0.5e-3 && dwell <= 1e-3) << dwell;
  EXPECT_FALSE(document({"--tune", "--method", "multi-focus"})["fingers"][0].contains("tune"));
}

TEST(CliMethods, RunPlaysEveryMethodAndEndsInSilence) {
  const auto folder = scratch_folder("methods");
  const auto play = [&](const std::string& method) {
    const std::string file = (folder / method).string();
    const Result result = palpa(with({"run", "--scene", asset("cube.glb"), "--frames", "20", "--hold", "1s", "--method",
                                      method, "--tune", "--link", "record:" + file, "--quiet"},
                                     small_frames()));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const session::DriveRecording recording = session::read_drive_recording(file);
    float least = 1, most = 0;
    for (const session::RecordedDrive& recorded : recording.drives) {
      float loudest = 0;
      for (const array::TransducerDrive& t : recorded.drive)
        loudest = std::max(loudest, t.amplitude);
      most = std::max(most, loudest);
      if (loudest > 1e-3F) least = std::min(least, loudest);
    }
    EXPECT_GT(most, 0.98F) << method;
    // Sampled at slots' midpoints, the modulation has the gains 0, sin 18 deg, sin 36 deg ... 1.
    EXPECT_NEAR(least, method == "ellipse" ? 1.0 : std::sin(M_PI / 10), 0.02) << method;
    for (const array::TransducerDrive& t : recording.drives.back().drive)
      ASSERT_EQ(t.amplitude, 0);
  };
  side_by_side({[&] { play("single-focus"); }, [&] { play("ellipse"); }, [&] { play("multi-focus"); }});
}

TEST(CliMethods, FociThatSoundTogetherAreSolvedUnlessToldOtherwise) {
  const auto folder = scratch_folder("together");
  // Phases of the first frame's drive: all foci sound in every slot, so that they are the same whichever slot it is.
  const auto phases = [&](const std::string& name, const std::vector<std::string>& options) {
    const std::string file = (folder / name).string();
    const std::vector<std::string> line{"run",    "--scene", asset("cube.glb"), "--backend", "cpu",    "--every-frame",
                                        "--hold", "1s",      "--frames",        "9",         "--link", "record:" + file,
                                        "--quiet"};
    const Result result = palpa(with(with(line, small_frames()), options));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<float> of_first;
    for (const session::RecordedDrive& recorded : session::read_drive_recording(file).drives) {
      const bool sounds = std::any_of(recorded.drive.begin(), recorded.drive.end(),
                                      [](const array::TransducerDrive& t) { return t.amplitude > 0; });
      if (!sounds) continue;
      for (const array::TransducerDrive& t : recorded.drive)
        of_first.push_back(t.phase);
      break;
    }
    EXPECT_FALSE(of_first.empty());
    return of_first;
  };
  std::vector<float> left_out, gs_pat, naive;
  side_by_side({[&] {
                  left_out = phases("left out", {"--method", "multi-focus"});
                },
                [&] {
                  gs_pat = phases("gs-pat", {"--method", "multi-focus", "--solver", "gs-pat"});
                },
                [&] {
                  naive = phases("naive", {"--method", "multi-focus", "--solver", "naive"});
                }});
  EXPECT_TRUE(left_out == gs_pat);
  EXPECT_FALSE(left_out == naive);
}

}  // namespace
}  // namespace palpa::test
