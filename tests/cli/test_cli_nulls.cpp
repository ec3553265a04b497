// `--null` and `--pattern`: exported drives recomputed by code of the test's own, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "cli/support/drive_here.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// |p| of a drive's table at a place, of transducers that sound alike in all directions.
double omni_sound(const std::vector<std::vector<double>>& drive, const std::vector<double>& place) {
  const double k = 2 * std::numbers::pi * 40e3 / (331.3 * std::sqrt(1 + 20 / 273.15));
  std::complex<double> sum = 0;
  for (const std::vector<double>& row : drive) {
    const double d = std::hypot(place[0] - row[1], place[1] - row[2], place[2] - row[3]);
    sum += std::polar(row[7] / d, row[8] + k * d);
  }
  return std::abs(sum);
}

const std::vector<std::string> two_and_two{"--layout",      "openmpd", "--focus",     "10mm,0,150mm", "--focus",
                                           "-1cm,5mm,0.15", "--null",  "0,2mm,150mm", "--null",       "10mm,15mm,0.14"};
const std::vector<std::string> one{"--layout", "openmpd", "--focus", "0,0,150mm"};

TEST(CliNulls, ExportedDrivesAreSilentThere) {
  for (const std::string backend : {"cpu", "gpu"}) {
    const auto rows = drive_here(with(two_and_two, {"--directivity", "omni"}), backend).rows;
    ASSERT_EQ(rows.size(), 256u);
    const double first = omni_sound(rows, {0.01, 0, 0.15}), second = omni_sound(rows, {-0.01, 0.005, 0.15});
    EXPECT_NEAR(first / second, 1, 0.01);
    for (const std::vector<double>& null : {std::vector{0.0, 0.002, 0.15}, std::vector{0.01, 0.015, 0.14}})
      EXPECT_LT(omni_sound(rows, null), 1e-4 * std::min(first, second)) << backend;
  }
}

TEST(CliNulls, TheSummaryAndTheJsonSayHowDeepTheyAre) {
  const Driven driven = drive_here(
      with(two_and_two, {"--constraint", "uniform", "--spread", "amplitude=10%,phase=0.2", "--draws", "40"}));
  EXPECT_CONTAINS(driven.told, "null at (0.00, 2.00, 150.00) mm: at most");
  const json& result = driven.report;
  ASSERT_EQ(result["nulls"].size(), 2u);
  for (const json& null : result["nulls"]) {
    EXPECT_LT(null["depth_db"], -80);
    EXPECT_EQ(null["radius_m"], 0);
  }
  EXPECT_EQ(result["nulls"][1]["place_m"], json({0.01, 0.015, 0.14}));
  EXPECT_GT(result["kept_with_nulls"], 0.7);
  // Transducers that differ from their data leave about a twentieth of the pressure of a focus.
  ASSERT_EQ(result["spread"]["nulls_pa"].size(), 2u);
  const double weakest = std::min(result["pressures_pa"][0].get<double>(), result["pressures_pa"][1].get<double>());
  for (const json& null : result["spread"]["nulls_pa"]) {
    EXPECT_GT(null[1], 0.002 * weakest);
    EXPECT_LT(null[2], 0.2 * weakest);
  }
  EXPECT_FALSE(drive_here(one).report.contains("nulls"));
  const Driven ball =
      drive_here({"--layout", "paper", "--focus", "0,0,0", "--null", "2cm,0,0,0.5mm", "--constraint", "uniform"});
  EXPECT_CONTAINS(ball.told, "Pa within 0.50 mm");
}

TEST(CliNulls, AFieldShowsThem) {
  const std::string csv = scratch_folder("nulls-field") / "field.csv";
  const Result result =
      palpa_here(with(with({"field"}, two_and_two), {"--line", "0,2mm,150mm", "10mm,0,150mm", "--samples", "2", "--csv",
                                                     csv, "--backend", "cpu", "--no-absorption"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto rows = read_csv(csv);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_LT(std::hypot(rows[0][3], rows[0][4]), 1e-4 * std::hypot(rows[1][3], rows[1][4]));
}

TEST(CliNulls, WhatCannotBeIsRefused) {
  const std::vector<std::string> cube{"--scene", source_file("assets/cube.glb")};
  std::vector<std::string> many;
  for (int i = 0; i < 65; ++i)
    many = with(many, {"--null", std::to_string(i) + "mm,2cm,150mm"});
  const std::vector<std::string> drive = with(with({"drive"}, one), {"--backend", "cpu"});
  const auto at = [&](const std::string& null, const std::vector<std::string>& more = {}) {
    return with(with(drive, {"--null", null}), more);
  };
  const std::string radius = "radius r from 0 to 5mm";
  const std::pair<std::vector<std::string>, std::string> wrong[]{
      {at("1,2"), "x,y,z"},
      {at("nan,0,0.1"), "x,y,z"},
      {at("0,2cm,0.15,-1mm"), radius},
      {at("0,2cm,0.15,6mm"), radius},
      {at("0,2cm,0.15,nan"), radius},
      {at("0,0,1e6"), "100 m"},
      {at("0,2cm,-20cm"), "lies behind the array"},
      {at("0,2cm,3"), "m from the nearest transducer"},
      {at("-78.75mm,78.75mm,0"), "transducer 0"},
      {at("0,0,150mm"), "null 1 is 0.00 mm from focus 1, closer than the array resolves"},
      {at("2cm,0,150mm", {"--null", "0,4.9mm,150mm,5mm"}), "focus 1 is within null 2, 4.90 mm from its centre"},
      {at("0,0,160mm"), "closer than the array resolves"},  // along the board's axis
      {at("0,2cm,0.15", {"--solver", "greedy"}), "--null goes with --solver gs-pat"},
      {at("0,2cm,0.15", {"--pressure", "500Pa"}), "--null: --pressure sets how loud foci are"},
      {at("0,2cm,0.15", {"--transfer", "finger", "--mesh", source_file("assets/finger.ply")}),
       "leave --transfer finger out"},
      {with(drive, many), "65 nulls are more than the 64"},
      {with(with({"run"}, cube),
            {"--frames", "1", "--backend", "cpu", "--link", "foci:udp:127.0.0.1:9", "--null", "2cm,0,0"}),
       "link foci sends foci and no drives"},
      {with(with({"simulate"}, cube), {"--finger", source_file("assets/finger.ply"), "--null", "2cm,0,0"}), "--null"}};
  for (const auto& [line, part] : wrong)
    expect_failure(palpa_here(line), 2, part);
  // Near a focus, a null costs much.
  const Result near = palpa_here(at("4mm,0,150mm", {"--csv", "-"}));
  EXPECT_EQ(near.exit_code, 0) << near.err;
  EXPECT_EQ(near.err_lines().size(), 1u) << near.err;
  EXPECT_CONTAINS(near.err, "closer than the array resolves there");
}

// A pattern's points are foci, and its silent places nulls.
TEST(CliNulls, APatternIsItsFociAndNulls) {
  const std::string file = scratch_folder("patterns") / "pattern.toml";
  write_text(file, R"([[curve]]
corners_m = [-0.01, 0, 0.15, 0.01, 0, 0.15]
points = 2
[[point]]
position_m = [0, 0.01, 0.15]
amplitude = 0
radius_m = 0.0005
)");
  const std::vector<std::string> openmpd{"--layout", "openmpd"};
  EXPECT_EQ(
      drive_here(with(openmpd, {"--pattern", file})).table,
      drive_here(with(openmpd, {"--focus", "-0.01,0,0.15", "--focus", "0.01,0,0.15", "--null", "0,0.01,0.15,0.0005"}))
          .table);
  write_text(file, "[[point]]\nposition_m = [0, 0, 0.15]\namplitude = -1\n");
  expect_failure(palpa_here(with({"drive", "--pattern", file}, openmpd)), 4, file + ": line 3");
}

// Palpa's own patterns by name, as docs/patterns.md has them, cause no warning.
TEST(CliNulls, PalpasOwnPatternsHaveNames) {
  for (const std::string name : {"carter", "gavrilov", "hasegawa", "hoshi", "inoue"}) {
    const json drive = drive_here({"--layout", "paper", "--pattern", name, "--constraint", "uniform"}).report;
    EXPECT_GT(drive["pressures_pa"][0].get<double>(), 1000) << name;
    EXPECT_EQ(drive.contains("nulls"), name == "carter");
  }
  // A user who gave no --null does not read of it.
  const std::pair<std::vector<std::string>, std::string> wrong[]{
      {{"--layout", "openmpd", "--pattern", "carter"}, "--pattern carter: null '"},
      {{"--layout", "paper", "--pattern", "carter", "--solver", "naive"},
       "--pattern carter goes with --solver gs-pat"}};
  for (const auto& [line, part] : wrong)
    expect_failure(palpa_here(with({"drive"}, line)), 2, part);
}

}  // namespace
}  // namespace palpa::test
