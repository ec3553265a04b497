// `palpa simulate`: its numbers are those of its table, its averages are those of the single drives, and its errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

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

std::vector<std::string> touch_of(const std::string& scene) {
  return {"simulate",  "--scene", source_file("assets/" + scene + ".glb"), "--finger", finger_file("tip", 0),
          "--backend", "cpu"};
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

void expect_spot(const json& spot, const Simulated& got, std::size_t column) {
  std::vector<double> peak = got.rows[0];
  for (const auto& row : got.rows) {
    if (row[column] > peak[column]) peak = row;
  }
  EXPECT_EQ(spot["peak_pa"], peak[column]);
  EXPECT_EQ(spot["peak_m"], (json{peak[1], peak[2], peak[3]}));
  double area = 0;
  for (const auto& row : got.rows)
    area += row[column] > peak[column] / 2 ? row[4] : 0;
  EXPECT_NEAR(spot["half_area_m2"], area, 1e-9 * area);
  EXPECT_NEAR(spot["half_radius_m"], std::sqrt(area / std::numbers::pi), 1e-9);
  EXPECT_GE(spot["elongation"], 1);
  EXPECT_EQ(spot.size(), 5u);
}

TEST(Simulate, TellsWhatItsTableHolds) {
  const Simulated got = simulate(with(touch_of("cube"), {"--penetration", "1.5mm"}));
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
  // The same bytes again.
  const std::string before = read_text(folder() / "out.csv");
  simulate(with(touch_of("cube"), {"--penetration", "1.5mm"}));
  EXPECT_EQ(read_text(folder() / "out.csv"), before);
}

TEST(Simulate, SaysThatItIsBeyondLinearAcoustics) {
  const auto told = [](const std::string& layout) {
    const Result result = palpa(with(touch_of("cube"), {"--penetration", "1.5mm", "--layout", layout}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.find("linear acoustics no longer holds") != std::string::npos;
  };
  EXPECT_TRUE(told("paper"));
  EXPECT_FALSE(told("openmpd"));
}

TEST(Simulate, AModulatedFocusIsHalfOfItsDrive) {
  // Its radiation pressure is a raised sine: on average half of what the drive alone gives.
  const Simulated got = simulate(
      with(touch_of("semi-sphere"), {"--penetration", "1.5mm", "--method", "single-focus", "--no-absorption"}));
  const json focus = got.results["foci_m"][0];
  const auto place = [](const json& p) { return p[0].dump() + "," + p[1].dump() + "," + p[2].dump(); };
  const std::string drive = folder() / "drive.csv";
  ASSERT_EQ(
      palpa_here({"drive", "--layout", "paper", "--focus", place(focus), "--csv", drive, "--backend", "cpu"}).exit_code,
      0);
  const Result alone = palpa_here(
      {"scatter", "--mesh", finger_file("lowered", -1.5e-3), "--layout", "paper", "--drive", drive, "--json", "-"});
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  const double up = json::parse(alone.out)["force_N"][1];
  EXPECT_NEAR(got.results["force_N"][1].get<double>() / up, 0.5, 1e-3);
}

TEST(Simulate, CamerasSeeTheSameTouch) {
  const std::vector<std::string> cube = with(touch_of("cube"), {"--penetration", "1.5mm"});
  const auto seen = [&](const std::vector<std::string>& more) {
    return simulate(with(cube, with({"--skin", "cameras"}, more))).results;
  };
  const json vertices = simulate(cube).results, exact = seen({"--noise-free"}), noisy = seen({"--seed", "7"});
  for (const json& cameras : {exact, noisy}) {
    ASSERT_EQ(cameras["foci_m"].size(), 10u);
    EXPECT_NE(cameras["foci_m"], vertices["foci_m"]);
    EXPECT_NEAR(cameras["force_N"][1].get<double>() / vertices["force_N"][1].get<double>(), 1, 0.15);
    EXPECT_NEAR(cameras["squared"]["half_radius_m"].get<double>(), vertices["squared"]["half_radius_m"], 0.6e-3);
  }
  EXPECT_EQ(seen({"--seed", "7"})["foci_m"], noisy["foci_m"]);
  EXPECT_NE(seen({"--seed", "8"})["foci_m"], noisy["foci_m"]);
  expect_failure(palpa_here(with(cube, {"--noise-free", "--json", "-"})), 2, "--skin cameras");
}

TEST(Simulate, FocusesOnTheFingerItself) {
  // Nothing is louder there than all transducers in phase.
  const std::vector<std::string> touch = with(touch_of("cube"), {"--penetration", "1.5mm", "--method", "single-focus",
                                                                 "--no-absorption", "--constraint", "uniform"});
  const Simulated before = simulate(touch), got = simulate(with(touch, {"--transfer", "finger"}));
  EXPECT_FALSE(before.results.contains("aimed_m"));
  ASSERT_EQ(got.results["aimed_m"].size(), 1u);
  const json place = got.results["aimed_m"][0];
  const auto near = std::ranges::min_element(got.rows, {}, [&](const std::vector<double>& row) {
    return std::hypot(row[1] - place[0].get<double>(), row[2] - place[1].get<double>(),
                      row[3] - place[2].get<double>());
  });
  const auto face = static_cast<std::size_t>(near - got.rows.begin());
  EXPECT_LE(std::hypot((*near)[1] - place[0].get<double>(), (*near)[2] - place[1].get<double>()), 1e-3);
  EXPECT_GE(got.rows[face][6], 0.99 * before.rows[face][6]);
  EXPECT_NE(got.rows[face][6], before.rows[face][6]);
  // Every method and solver goes with it.
  for (const char* const method : {"cross-section", "multi-focus"}) {
    const Simulated all =
        simulate(with(touch_of("cube"), {"--penetration", "1.5mm", "--method", method, "--transfer", "finger"}));
    EXPECT_EQ(all.results["aimed_m"].size(), all.results["foci_m"].size());
    EXPECT_GT(all.results["langevin"]["peak_pa"], 0);
  }
}

TEST(Simulate, SpectrumAndTuneAreOfTheSoundOnTheFinger) {
  const std::vector<std::string> touch =
      with(touch_of("cube"), {"--penetration", "1.5mm", "--foci", "4", "--stride", "1", "--layout", "openmpd"});
  const auto fingers = [&](const std::vector<std::string>& more) {
    const json results = simulate(with(touch, more)).results;
    EXPECT_EQ(results["fingers"].size(), 1u);
    return results["fingers"][0];
  };
  EXPECT_FALSE(simulate(touch).results.contains("fingers"));
  const json free = fingers({"--spectrum"}), here = fingers({"--spectrum", "--transfer", "finger"});
  for (const json& finger : {free, here}) {
    EXPECT_EQ(finger["solid"], "cube");
    EXPECT_FALSE(finger.contains("tune"));
    EXPECT_EQ(finger["spectrum"]["field"], "finger");
    EXPECT_NEAR(finger["spectrum"]["lines"][0]["frequency_hz"], 1 / (4 * 1.5e-3), 1e-9);
    EXPECT_GT(finger["spectrum"]["felt_share"], 0.1);
  }
  EXPECT_NE(free["spectrum"]["felt_share"], here["spectrum"]["felt_share"]);
  // Its skin point is on the ball; foci lie within.
  const json skin = free["spectrum"]["skin_m"];
  const double lowest = -1.5e-3;
  EXPECT_NEAR(std::hypot(skin[0].get<double>(), skin[1].get<double>() - lowest - 5e-3, skin[2].get<double>()), 5e-3,
              3e-4);
  // Spots: as for any touch.
  EXPECT_EQ(fingers({"--spectrum", "--spot", "4mm"})["spectrum"]["field"], "spot");
  EXPECT_EQ(fingers({"--tune"})["tune"]["field"], "finger");
  const std::vector<std::string> air{"touch",
                                     "--scene",
                                     source_file("assets/cube.glb"),
                                     "--points",
                                     finger_file("tip", 0),
                                     "--penetration",
                                     "1.5mm",
                                     "--foci",
                                     "4",
                                     "--stride",
                                     "1",
                                     "--layout",
                                     "openmpd",
                                     "--backend",
                                     "cpu",
                                     "--spectrum",
                                     "--json",
                                     "-"};
  EXPECT_EQ(json::parse(palpa_here(air).out)["fingers"][0]["spectrum"]["field"], "array");
  expect_failure(palpa_here(with(touch, {"--spot", "4mm", "--json", "-"})), 2, "--spot goes with");
}

TEST(Simulate, SaysOnceThatAPressureIsNotReached) {
  const std::vector<std::string> touch = with(touch_of("cube"), {"--penetration", "1.5mm", "--layout", "openmpd"});
  for (const char* const transfer : {"free", "finger"}) {
    const Result loud = palpa_here(with(touch, {"--transfer", transfer, "--pressure", "50kPa"}));
    EXPECT_EQ(loud.exit_code, 0);
    ASSERT_EQ(loud.err_lines().size(), 1u) << loud.err;
    EXPECT_NE(loud.err.find("50000 Pa"), std::string::npos) << loud.err;
    EXPECT_EQ(palpa_here(with(touch, {"--transfer", transfer, "--pressure", "500Pa"})).err, "");
  }
}

/// The paper's rig with every seventeenth of its transducers: the same focus for less time.
std::string sparse_rig() {
  const std::string drive = folder() / "all.csv";
  EXPECT_EQ(
      palpa_here({"drive", "--layout", "paper", "--focus", "0,0,0", "--csv", drive, "--backend", "cpu"}).exit_code, 0);
  std::ofstream layout(folder() / "sparse.toml");
  const auto rows = read_csv(drive);
  for (std::size_t i = 0; i < rows.size(); i += 17) {
    const auto& r = rows[i];
    layout << "[[transducer]]\nposition_m = [" << r[1] << ", " << r[2] << ", " << r[3] << "]\naxis = [" << r[4] << ", "
           << r[5] << ", " << r[6] << "]\n";
  }
  std::string rig = read_text(source_file("assets/rigs/paper.toml"));
  const std::string named = "layout = \"paper\"";
  const std::size_t at = rig.find(named);
  EXPECT_NE(at, std::string::npos);
  rig.replace(at, named.size(), "layout = \"sparse.toml\"");
  const std::filesystem::path file = folder() / "rig.toml";
  std::ofstream(file) << rig;
  return file;
}

TEST(Simulate, TheFigureIsThePapers) {
  const std::string png = folder() / "figure6.png";
  const Result result = palpa({"simulate", "--figure6", "--finger", finger_file("fine-tip", 0, 8), "--penetration",
                               "3mm", "--backend", "cpu", "--rig", sparse_rig(), "--png", png, "--json", "-"});
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
  expect_failure(palpa_here({"simulate", "--figure6", "--scene", "a.glb"}), 2, "--figure6");
}

TEST(Simulate, LongWorkSaysWhatItDoesAndStopsOnCtrlC) {
  PALPA_TERMINAL_OR_SKIP();
  const std::filesystem::path out = folder() / "out-of-ctrl-c";
  std::filesystem::remove_all(out);
  std::filesystem::create_directories(out);
  Terminal terminal({"simulate", "--scene", source_file("assets/cube.glb"), "--finger",
                     finger_file("large", 0, 22, 15e-3), "--backend", "cpu", "--csv", out / "a.csv", "--vtu",
                     out / "a.vtu", "--png", out / "a.png", "--json", out / "a.json"});
  EXPECT_TRUE(terminal.shows("filling the matrix of the surface")) << terminal.text();
  terminal.type("\x03");
  EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
  EXPECT_LT(terminal.processor_s_to_end(), slowest);
  EXPECT_TRUE(std::filesystem::is_empty(out));
}

TEST(Simulate, RefusesWhatCannotBe) {
  const std::vector<std::string> cube = touch_of("cube");
  expect_failure(palpa_here(with(cube, {"--penetration", "-2mm", "--json", "-"})), 4, "touches nothing there");
  expect_failure(palpa_here({"simulate", "--finger", finger_file("tip", 0)}), 2, "--scene is missing");
  expect_failure(palpa_here({"simulate", "--scene", source_file("assets/cube.glb")}), 2, "--finger is missing");
  expect_failure(palpa_here(with(cube, {"--layout", "openmpd", "--penetration", "153mm", "--json", "-"})), 4,
                 "stands in the array");
  geometry::Mesh open = geometry::icosphere(5e-3, 5);
  open.triangles.pop_back();
  const std::filesystem::path file = folder() / "open.ply";
  geometry::write_ply(file, open.positions, open.triangles);
  expect_failure(palpa_here({"simulate", "--scene", source_file("assets/cube.glb"), "--finger", file, "--json", "-"}),
                 4, "the mesh is open");
}

}  // namespace
}  // namespace palpa::test
