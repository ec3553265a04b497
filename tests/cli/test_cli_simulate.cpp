// `palpa simulate`: its averages are those of the single drives. tests/python/test_every_number.py has its numbers.
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

json simulate(const std::vector<std::string>& arguments) {
  const std::string csv = folder() / "out.csv", file = folder() / "out.json";
  succeeded(palpa_here(with(arguments, {"--csv", csv, "--json", file})));
  EXPECT_TRUE(read_text(csv).starts_with("face,x,y,z,area,langevin,squared\n"));
  return json::parse(read_text(file));
}

TEST(Simulate, AModulatedFocusIsHalfOfItsDrive) {
  // Its radiation pressure is a raised sine: on average half of what the drive alone gives.
  const json got = simulate(touch_of("semi-sphere", {"--method", "single-focus", "--no-absorption"}));
  const json focus = got["foci_m"][0];
  const std::string drive = folder() / "drive.csv";
  write_text(drive, drive_here({"--layout", "paper", "--focus",
                                focus[0].dump() + "," + focus[1].dump() + "," + focus[2].dump()})
                        .table);
  const Result alone = succeeded(palpa_here(
      {"scatter", "--mesh", finger_file("lowered", -1.5e-3), "--layout", "paper", "--drive", drive, "--json", "-"}));
  const double up = json::parse(alone.out)["force_N"][1];
  EXPECT_NEAR(got["force_N"][1].get<double>() / up, 0.5, 1e-3);
}

TEST(Simulate, CamerasSeeTheSameTouch) {
  const auto seen = [](const std::vector<std::string>& more) {
    return simulate(touch_of("cube", with({"--skin", "cameras"}, more)));
  };
  const json vertices = simulate(touch_of("cube")), exact = seen({"--noise-free"}), noisy = seen({"--seed", "7"});
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
    const json results = simulate(with(touch, more));
    EXPECT_EQ(results["fingers"].size(), 1u);
    return results["fingers"][0];
  };
  EXPECT_FALSE(simulate(touch).contains("fingers"));
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
    const std::string told = palpa_here(touch_of("cube", {"--layout", layout, "--amplitude", "distance"})).out;
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
  const Result result =
      succeeded(palpa_here({"simulate", "--figure6", "--finger", finger_file("fine-tip", 0, 8), "--penetration", "3mm",
                            "--backend", "cpu", "--rig", rig, "--png", png, "--json", "-"}));
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
