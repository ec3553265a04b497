// `--null` of drive, field and run: exported drives recomputed by code of the test's own, and what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<double>>;

Rows rows_of(const Result& result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  Rows rows;
  std::istringstream text(result.out);
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(std::stod(cell));
  }
  return rows;
}

/// |p| of the rows of `palpa drive --csv` at a place, of transducers that sound alike in all directions.
double omni_sound(const Rows& drive, const std::vector<double>& place) {
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
const std::vector<std::vector<double>> foci{{0.01, 0, 0.15}, {-0.01, 0.005, 0.15}},
    nulls{{0, 0.002, 0.15}, {0.01, 0.015, 0.14}};

TEST(CliNulls, ExportedDrivesAreSilentThere) {
  for (const std::string constraint : {"normalise", "uniform", "clamp"}) {
    for (const std::string backend : {"cpu", "gpu"}) {
      const Rows drive =
          rows_of(palpa_here(with(with({"drive"}, two_and_two), {"--directivity", "omni", "--constraint", constraint,
                                                                 "--backend", backend, "--csv", "-"})));
      ASSERT_EQ(drive.size(), 256u);
      const double first = omni_sound(drive, foci[0]), second = omni_sound(drive, foci[1]);
      EXPECT_NEAR(first / second, 1, 0.01) << constraint;
      for (const std::vector<double>& null : nulls)
        EXPECT_LT(omni_sound(drive, null), 1e-4 * std::min(first, second)) << constraint << " " << backend;
    }
  }
}

TEST(CliNulls, TheSummaryAndTheJsonSayHowDeepTheyAre) {
  const std::vector<std::string> line =
      with(with({"drive"}, two_and_two),
           {"--constraint", "uniform", "--backend", "cpu", "--spread", "amplitude=10%,phase=0.2", "--draws", "40"});
  const Result told = palpa_here(line);
  EXPECT_EQ(told.err, "");
  EXPECT_NE(told.out.find("null at (0.00, 2.00, 150.00) mm: at most"), std::string::npos) << told.out;
  const json result = json::parse(palpa_here(with(line, {"--json", "-"})).out);
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
  const json without = json::parse(
      palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,15cm", "--backend", "cpu", "--json", "-"}).out);
  EXPECT_FALSE(without.contains("nulls"));
}

TEST(CliNulls, AFieldShowsThem) {
  const std::vector<std::string> line{"--line", "0,2mm,150mm", "10mm,0,150mm", "--samples", "2",
                                      "--csv",  "-",           "--backend",    "cpu"};
  const auto ratio = [&](const std::vector<std::string>& more) {
    const Rows rows = rows_of(palpa_here(with(with(with({"field"}, two_and_two), line), more)));
    EXPECT_EQ(rows.size(), 2u);
    return std::hypot(rows[0][3], rows[0][4]) / std::hypot(rows[1][3], rows[1][4]);
  };
  EXPECT_LT(ratio({"--no-absorption"}), 1e-4);
  EXPECT_LT(ratio({}), 3e-3) << "absorption depends on the way, so nulls are less deep";
}

TEST(CliNulls, ABallIsReported) {
  const Result told = palpa_here({"drive", "--layout", "paper", "--focus", "0,0,0", "--null", "2cm,0,0,0.5mm",
                                  "--constraint", "uniform", "--backend", "cpu"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_EQ(told.err, "");
  EXPECT_NE(told.out.find("Pa within 0.50 mm"), std::string::npos) << told.out;
}

TEST(CliNulls, RefusesWhatCannotBe) {
  const auto refused = [](const std::vector<std::string>& more, const std::string& text) {
    expect_failure(palpa_here(with({"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--backend", "cpu"}, more)),
                   2, text);
  };
  refused({"--null", "1,2"}, "x,y,z");
  refused({"--null", "nan,0,0.1"}, "x,y,z");
  refused({"--null", "0,2cm,0.15,-1mm"}, "radius r from 0 to 5mm");
  refused({"--null", "0,2cm,0.15,6mm"}, "radius r from 0 to 5mm");
  refused({"--null", "0,2cm,0.15,nan"}, "radius r from 0 to 5mm");
  refused({"--null", "0,0,1e6"}, "100 m");
  refused({"--null", "0,2cm,-20cm"}, "lies behind the array");
  refused({"--null", "0,2cm,3"}, "m from the nearest transducer");
  refused({"--null", "-78.75mm,78.75mm,0"}, "transducer 0");
  refused({"--null", "0,0,150mm"}, "null 1 is 0.00 mm from focus 1, closer than the array resolves");
  refused({"--null", "2cm,0,150mm", "--null", "0,4.9mm,150mm,5mm"},
          "focus 1 is within null 2, 4.90 mm from its centre");
  refused({"--null", "0,0,160mm"}, "closer than the array resolves");  // along the board's axis
  refused({"--null", "0,2cm,0.15", "--solver", "greedy"}, "--null goes with --solver gs-pat");
  refused({"--null", "0,2cm,0.15", "--pressure", "500Pa"}, "--null: --pressure sets how loud foci are");
  refused({"--null", "0,2cm,0.15", "--transfer", "finger", "--mesh", source_file("assets/finger.ply")},
          "leave --transfer finger out");
  std::vector<std::string> many;
  for (int i = 0; i < 65; ++i)
    many = with(many, {"--null", std::to_string(i) + "mm,2cm,150mm"});
  refused(many, "65 nulls are more than the 64");
  expect_failure(palpa_here({"run", "--scene", source_file("assets/cube.glb"), "--frames", "1", "--backend", "cpu",
                             "--link", "foci:udp:127.0.0.1:9", "--null", "2cm,0,0"}),
                 2, "link foci sends foci and no drives");
  expect_failure(palpa_here({"simulate", "--scene", source_file("assets/cube.glb"), "--finger",
                             source_file("assets/finger.ply"), "--null", "2cm,0,0"}),
                 2, "--null");
}

TEST(CliNulls, WarnsWhereTheyCostMuch) {
  const auto warned = [](const std::vector<std::string>& more) {
    const Result result = palpa_here(
        with({"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--backend", "cpu", "--csv", "-"}, more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err_lines().size(), 1u) << result.err;
    return result.err;
  };
  EXPECT_NE(warned({"--null", "4mm,0,150mm"}).find("closer than the array resolves there"), std::string::npos);
}

// A pattern's points are foci, and its silent places nulls.
TEST(CliNulls, APatternIsItsFociAndNulls) {
  const auto folder = scratch_folder("patterns");
  const std::string file = folder / "pattern.toml";
  write_text(file, R"([[curve]]
corners_m = [-0.01, 0, 0.15, 0.01, 0, 0.15]
points = 2
[[point]]
position_m = [0, 0.01, 0.15]
amplitude = 0
radius_m = 0.0005
)");
  const std::vector<std::string> rest{"--layout", "openmpd", "--backend", "cpu", "--csv", "-"};
  const Result pattern = palpa_here(with({"drive", "--pattern", file}, rest));
  EXPECT_EQ(pattern.exit_code, 0) << pattern.err;
  const std::vector<std::string> same{"--focus",     "-0.01,0,0.15", "--focus",
                                      "0.01,0,0.15", "--null",       "0,0.01,0.15,0.0005"};
  EXPECT_EQ(pattern.out, palpa_here(with(with({"drive"}, same), rest)).out);
  expect_failure(palpa_here(with({"drive", "--pattern", file, "--focus", "0,0,0.1"}, rest)), 2, "exclude each other");
  write_text(file, "[[point]]\nposition_m = [0, 0, 0.15]\namplitude = -1\n");
  expect_failure(palpa_here(with({"drive", "--pattern", file}, rest)), 4, file + ": line 3");
}

// Palpa's own patterns by name, as docs/patterns.md has them.
TEST(CliNulls, PalpasOwnPatternsHaveNames) {
  for (const char* name : {"carter", "gavrilov", "hasegawa", "hoshi", "inoue"}) {
    const Result result = palpa_here({"drive", "--layout", "paper", "--pattern", name, "--constraint", "uniform",
                                      "--backend", "cpu", "--json", "-", "--quiet"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "") << name << " causes no warning";
    const nlohmann::json drive = nlohmann::json::parse(result.out);
    EXPECT_GT(drive["pressures_pa"][0].get<double>(), 1000) << name;
    EXPECT_EQ(drive.contains("nulls"), std::string(name) == "carter");
  }
  // A user who gave no --null does not read of it.
  expect_failure(palpa_here({"drive", "--layout", "openmpd", "--pattern", "carter"}), 2, "--pattern carter: null '");
  expect_failure(palpa_here({"drive", "--layout", "paper", "--pattern", "carter", "--solver", "naive"}), 2,
                 "--pattern carter goes with --solver gs-pat");
  expect_failure(palpa_here({"drive", "--layout", "paper", "--pattern", "carters"}), 4, "neither a file nor a known");
}

TEST(CliNulls, ARunPlaysThem) {
  const auto folder = scratch_folder("nulls-run");
  const std::string file = (folder / "drives.bin").string();
  const Result result =
      palpa_here({"run", "--scene", source_file("assets/cube.glb"), "--frames", "2", "--every-frame", "--noise-free",
                  "--backend", "cpu", "--link", "record:" + file, "--null", "30mm,10mm,0"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
}

}  // namespace
}  // namespace palpa::test
