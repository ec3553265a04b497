// `palpa simulate`: its numbers are those of its table, its averages are those of the single drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/drive_here.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::filesystem::path& folder() {
  static const std::filesystem::path folder = scratch_folder("simulate");
  return folder;
}

/// A fingertip: a sphere, its lowest vertex at 0, y, 0.
std::string finger_file(const std::string& name, double y, int divisions = 5, double radius = 5e-3) {
  geometry::Mesh mesh = geometry::icosphere(radius, divisions);
  const Vec3 lowest = *std::ranges::min_element(mesh.positions, {}, &Vec3::y);
  for (Vec3& p : mesh.positions)
    p += Vec3(0, y, 0) - lowest;
  const std::filesystem::path file = folder() / (name + ".ply");
  geometry::write_ply(file, mesh.positions, mesh.triangles);
  return file;
}

/// The fingertip 1.5 mm deep in an object of the paper.
std::vector<std::string> touch_of(const std::string& object, const std::vector<std::string>& more = {}) {
  return with({"simulate", "--scene", source_file("assets/" + object + ".glb"), "--finger", finger_file("tip", 0),
               "--penetration", "1.5mm", "--backend", "cpu"},
              more);
}

struct Simulated {
  json results;
  std::vector<std::vector<double>> rows;
};

Simulated simulate(const std::vector<std::string>& arguments) {
  const std::string csv = folder() / "out.csv", file = folder() / "out.json";
  const Result result = palpa_here(with(arguments, {"--csv", csv, "--json", file}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(read_text(csv).starts_with("face,x,y,z,area,langevin,squared\n"));
  return {json::parse(read_text(file)), read_csv(csv)};
}

/// How a spot is measured: tests/acoustics/test_scattering.cpp.
void expect_spot(const json& spot, const Simulated& got, std::size_t column) {
  const auto peak =
      *std::ranges::max_element(got.rows, {}, [&](const std::vector<double>& row) { return row[column]; });
  EXPECT_EQ(spot["peak_pa"], peak[column]);
  EXPECT_EQ(spot["peak_m"], (json{peak[1], peak[2], peak[3]}));
  double area = 0;
  for (const auto& row : got.rows)
    area += row[column] > peak[column] / 2 ? row[4] : 0;
  EXPECT_NEAR(spot["half_area_m2"], area, 1e-9 * area);
  EXPECT_EQ(spot.size(), 5u);
}

TEST(Simulate, TellsWhatItsTableHolds) {
  const Simulated got = simulate(touch_of("cube"));
  ASSERT_EQ(got.rows.size(), 500u);
  const json& results = got.results;
  EXPECT_EQ(results["finger"], (json{{"faces", 500}, {"vertices", 252}}));
  EXPECT_EQ(results["method"], "cross-section");
  EXPECT_EQ(results["penetration_m"], 0.0015);
  EXPECT_EQ(results["foci_m"].size(), 10u);
  EXPECT_EQ(results.size(), 10u) << results.dump();
  expect_spot(results["langevin"], got, 5);
  expect_spot(results["squared"], got, 6);
  // The pressure is on the tip, which is where the foci are, and pushes it up.
  EXPECT_LT(results["langevin"]["peak_m"][1], 0);
  EXPECT_GT(results["force_N"][1], 0);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(results["force_far_N"][axis].get<double>(), results["force_N"][axis],
                0.02 * results["force_N"][1].get<double>());
  }
  for (const auto& row : got.rows)
    EXPECT_LE(row[5], row[6] * (1 + 1e-12));
  // Where the tip is, force times lever is torque.
  EXPECT_LE(std::abs(results["torque_Nm"][0].get<double>()), 5e-3 * results["force_N"][1].get<double>());
}

TEST(Simulate, AModulatedFocusIsHalfOfItsDrive) {
  // Its radiation pressure is a raised sine: on average half of what the drive alone gives.
  const Simulated got = simulate(touch_of("semi-sphere", {"--method", "single-focus", "--no-absorption"}));
  const json focus = got.results["foci_m"][0];
  const std::string drive = folder() / "drive.csv";
  write_text(drive, drive_here({"--layout", "paper", "--focus",
                                focus[0].dump() + "," + focus[1].dump() + "," + focus[2].dump()})
                        .table);
  const Result alone = palpa_here(
      {"scatter", "--mesh", finger_file("lowered", -1.5e-3), "--layout", "paper", "--drive", drive, "--json", "-"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const double up = json::parse(alone.out)["force_N"][1];
  EXPECT_NEAR(got.results["force_N"][1].get<double>() / up, 0.5, 1e-3);
}

TEST(Simulate, CamerasSeeTheSameTouch) {
  const auto seen = [](const std::vector<std::string>& more) {
    return simulate(touch_of("cube", with({"--skin", "cameras"}, more))).results;
  };
  const json vertices = simulate(touch_of("cube")).results, exact = seen({"--noise-free"}),
             noisy = seen({"--seed", "7"});
  for (const json& cameras : {exact, noisy}) {
    ASSERT_EQ(cameras["foci_m"].size(), 10u);
    EXPECT_NE(cameras["foci_m"], vertices["foci_m"]);
    EXPECT_NEAR(cameras["force_N"][1].get<double>() / vertices["force_N"][1].get<double>(), 1, 0.15);
    EXPECT_NEAR(cameras["squared"]["half_radius_m"].get<double>(), vertices["squared"]["half_radius_m"], 0.6e-3);
  }
  EXPECT_NE(seen({"--seed", "8"})["foci_m"], noisy["foci_m"]);
}

TEST(Simulate, SpectrumAndTuneAreOfTheSoundOnTheFinger) {
  const std::vector<std::string> touch = touch_of("cube", {"--foci", "4", "--stride", "1", "--layout", "openmpd"});
  const auto finger = [&](const std::vector<std::string>& more) {
    const json results = simulate(with(touch, more)).results;
    EXPECT_EQ(results["fingers"].size(), 1u);
    return results["fingers"][0];
  };
  EXPECT_FALSE(simulate(touch).results.contains("fingers"));
  const json free = finger({"--spectrum"}), here = finger({"--spectrum", "--transfer", "finger"});
  for (const json& felt : {free, here}) {
    EXPECT_EQ(felt["solid"], "cube");
    EXPECT_FALSE(felt.contains("tune"));
    EXPECT_EQ(felt["spectrum"]["field"], "finger");
  }
  EXPECT_NE(free["spectrum"]["felt_share"], here["spectrum"]["felt_share"]);
  // Its skin point is on the ball; foci lie within.
  const json skin = free["spectrum"]["skin_m"];
  EXPECT_NEAR(std::hypot(skin[0].get<double>(), skin[1].get<double>() + 1.5e-3 - 5e-3, skin[2].get<double>()), 5e-3,
              3e-4);
  // Spots: as for any touch.
  EXPECT_EQ(finger({"--spectrum", "--spot", "4mm"})["spectrum"]["field"], "spot");
  EXPECT_EQ(finger({"--tune"})["tune"]["field"], "finger");
}

TEST(Simulate, WhatIsBeyondTheArrayOrLinearAcousticsIsTold) {
  for (const std::string layout : {"paper", "openmpd"}) {
    const std::string told = palpa_here(touch_of("cube", {"--layout", layout})).out;
    EXPECT_EQ(told.find("linear acoustics no longer holds") != std::string::npos, layout == "paper") << told;
  }
  for (const char* const transfer : {"free", "finger"}) {
    const std::vector<std::string> touch = touch_of("cube", {"--layout", "openmpd", "--transfer", transfer});
    const Result loud = palpa_here(with(touch, {"--pressure", "50kPa"}));
    EXPECT_EQ(loud.exit_code, 0);
    ASSERT_EQ(loud.err_lines().size(), 1u) << loud.err;
    EXPECT_CONTAINS(loud.err, "50000 Pa");
    EXPECT_EQ(palpa_here(with(touch, {"--pressure", "500Pa"})).err, "");
  }
}

/// The paper's rig with every seventeenth of its transducers: the same focus for less time.
std::string sparse_rig() {
  std::ostringstream layout;
  const auto rows = drive_here({"--layout", "paper", "--focus", "0,0,0"}).rows;
  for (std::size_t i = 0; i < rows.size(); i += 17) {
    const auto& r = rows[i];
    layout << "[[transducer]]\nposition_m = [" << r[1] << ", " << r[2] << ", " << r[3] << "]\naxis = [" << r[4] << ", "
           << r[5] << ", " << r[6] << "]\n";
  }
  write_text(folder() / "sparse.toml", layout.str());
  std::string rig = read_text(source_file("assets/rigs/paper.toml"));
  const std::string named = "layout = \"paper\"";
  const std::size_t at = rig.find(named);
  EXPECT_NE(at, std::string::npos);
  write_text(folder() / "rig.toml", rig.replace(at, named.size(), "layout = \"sparse.toml\""));
  return folder() / "rig.toml";
}

TEST(Simulate, TheFigureIsThePapers) {
  const std::string png = folder() / "figure6.png";
  const std::string rig = sparse_rig();
  const Result result = palpa_here({"simulate", "--figure6", "--finger", finger_file("fine-tip", 0, 8), "--penetration",
                                    "3mm", "--backend", "cpu", "--rig", rig, "--png", png, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json all = json::parse(result.out);
  ASSERT_EQ(all.size(), 20u);
  std::vector<json> paper;
  for (const json& touch : all) {
    EXPECT_GE(touch["bare_elongation"], 1);
    if (touch["method"] == "cross-section") paper.push_back(touch);
  }
  ASSERT_EQ(paper.size(), 5u);
  const char* const objects[]{"cube", "semi-sphere", "pyramid", "prism", "prism-along-x"};
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_EQ(paper[i]["object"], objects[i]);
  const auto area = [&](std::size_t i) { return paper[i]["squared"]["half_area_m2"].get<double>(); };
  // The cube's follows the cross-section, the pyramid's is a single focus, the prism's is long, along its ridge.
  EXPECT_GT(area(0), area(1));
  EXPECT_GT(area(1), 1.5 * area(2));
  EXPECT_GT(area(3), 1.1 * area(2));
  EXPECT_GT(paper[3]["squared"]["elongation"], paper[4]["squared"]["elongation"]);
  EXPECT_TRUE(read_text(png).starts_with("\x89PNG"));
}

}  // namespace
}  // namespace palpa::test
