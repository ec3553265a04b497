// `palpa touch` with the paper's finger and objects: the contract's JSON, its numbers against an independent
// computation, and the same answer on every backend and thread count.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <sstream>

#include "cli/support/here.hpp"
#include "cli/support/touch_here.hpp"
#include "cli/support/touch_json.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

std::vector<std::string> cube_touch() {
  return {"--scene", asset("cube.glb"), "--points", asset("finger.ply"), "--penetration", "3mm"};
}

/// The finger as --penetration 3mm places it on an object whose top is at y = 0.
std::vector<Vec3> lowered_finger(double penetration = 3e-3) {
  std::vector<Vec3> points = geometry::read_ply(asset("finger.ply")).positions;
  double lowest = points[0].y;
  for (const Vec3& p : points)
    lowest = std::min(lowest, p.y);
  for (Vec3& p : points)
    p.y += -penetration - lowest;
  return points;
}

/// Eq. (1) for the 4 cm cube below y = 0, written down by hand.
double depth_in_cube(const Vec3& p) {
  return std::min({0.02 - std::abs(p.x), 0.02 - std::abs(p.z), -p.y, p.y + 0.04});
}

class Touch : public testing::TestWithParam<std::string> {
 protected:
  std::vector<std::string> here(const std::vector<std::string>& arguments) {
    return with(arguments, {"--backend", GetParam()});
  }
};

TEST_P(Touch, ContactsOnTheCubeAreThoseOfEquationOne) {
  const TouchReport report = run_touch_here(here(cube_touch()));
  const std::vector<Vec3> points = lowered_finger();
  EXPECT_EQ(report.points, points.size());
  std::vector<std::uint32_t> expected;
  Vec3 sum(0);
  std::size_t at = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double depth = depth_in_cube(points[i]);
    const bool listed = at < report.contacts.size() && report.contacts[at] == i;
    // Within a micrometre of the shell's boundary single precision may decide either way.
    if (std::abs(depth) > 1e-6 && std::abs(depth - 1.5e-3) > 1e-6) {
      EXPECT_EQ(listed, depth > 0 && depth < 1.5e-3) << i;
    }
    if (!listed) continue;
    EXPECT_NEAR(report.depths[at], depth, 1e-6);
    sum += points[i];
    ++at;
  }
  EXPECT_EQ(at, report.contacts.size());
  ASSERT_EQ(report.fingers.size(), 1u);
  EXPECT_EQ(report.fingers[0].indices, report.contacts);
  EXPECT_LT(glm::distance(report.fingers[0].centroid, sum / static_cast<double>(at)), 1e-6);
}

TEST_P(Touch, OptionsReachTheJson) {
  const auto document = [&](const std::vector<std::string>& more) {
    const Result result = palpa_here(with(with({"touch"}, here(cube_touch())), with(more, {"--json", "-"})));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(result.out);
  };
  const json usual = document({});
  EXPECT_EQ(usual["schedule"]["order"], json::parse("[0,3,6,9,2,5,8,1,4,7]"));
  EXPECT_EQ(usual["schedule"]["dwell_s"], 0.0015);
  EXPECT_EQ(usual["fingers"][0]["foci_m"].size(), 10u);

  const json seven = document({"--foci", "7", "--stride", "2", "--dwell", "2ms"});
  EXPECT_EQ(seven["schedule"]["order"], json::parse("[0,2,4,6,1,3,5]"));
  EXPECT_EQ(seven["schedule"]["dwell_s"], 0.002);
  EXPECT_EQ(seven["fingers"][0]["foci_m"].size(), 7u);

  EXPECT_GT(document({"--delta", "3mm"})["contacts"]["count"], usual["contacts"]["count"]);
  const json few = document({"--min-points", "100000"});
  EXPECT_EQ(few["fingers"].size(), 0u);
  EXPECT_EQ(few["contacts"], usual["contacts"]);
  // Vertices lie half a millimetre and more apart: with a smaller gap, the ring falls into single points.
  EXPECT_GT(document({"--finger-gap", "0.4mm", "--min-points", "1"})["fingers"].size(), 10u);
}

TEST_P(Touch, NoTouchIsNoError) {
  const TouchReport report =
      run_touch_here(here({"--scene", asset("cube.glb"), "--points", asset("finger.ply"), "--penetration", "-1mm"}));
  EXPECT_TRUE(report.contacts.empty());
  EXPECT_TRUE(report.fingers.empty());
}

TEST_P(Touch, TwoFingersAreTwo) {
  std::vector<Vec3> points = lowered_finger();
  const std::size_t one = points.size();
  // Half the cube apart: each finger's ring of contacts is about 13 mm wide.
  for (std::size_t i = 0; i < one; ++i) {
    points.push_back(points[i] + Vec3(0.01, 0, 0));
    points[i].x -= 0.01;
  }
  const auto file = scratch_folder("two-fingers") / "two.ply";
  geometry::write_ply(file, points);
  const TouchReport report = run_touch_here(here({"--scene", asset("cube.glb"), "--points", file.string()}));
  ASSERT_EQ(report.fingers.size(), 2u);
  EXPECT_LT(report.fingers[0].indices.back(), one);
  EXPECT_GE(report.fingers[1].indices.front(), one);
  EXPECT_LT(report.fingers[0].centroid.x, -5e-3);
  EXPECT_GT(report.fingers[1].centroid.x, 5e-3);
}

TEST_P(Touch, OneAndTwoContactsGiveFiniteNumbers) {
  const auto file = scratch_folder("few") / "few.ply";
  for (const std::vector<Vec3>& points :
       {std::vector<Vec3>{{0, -1e-3, 0}}, std::vector<Vec3>{{0, -1e-3, 0}, {1e-3, -1e-3, 0}},
        std::vector<Vec3>{{0, -1e-3, 0}, {0, -1e-3, 0}, {0, -1e-3, 0}, {0, -1e-3, 0}}}) {
    geometry::write_ply(file, points);
    // run_touch fails on any null where a number must be.
    const TouchReport report =
        run_touch_here(here({"--scene", asset("cube.glb"), "--points", file.string(), "--min-points", "1"}));
    ASSERT_EQ(report.fingers.size(), 1u) << points.size();
    EXPECT_LT(glm::distance(report.fingers[0].centroid, (points.front() + points.back()) / 2.0), 1e-6);
  }
}

TEST_P(Touch, AnEmptyPointCloudIsNoError) {
  const auto file = scratch_folder("empty") / "empty.ply";
  geometry::write_ply(file, {});
  for (const auto& more : {std::vector<std::string>{}, {"--penetration", "3mm"}}) {
    const TouchReport report =
        run_touch_here(here(with({"--scene", asset("cube.glb"), "--points", file.string()}, more)));
    EXPECT_EQ(report.points, 0u);
    EXPECT_TRUE(report.contacts.empty());
  }
}

TEST_P(Touch, MoreThan64FingersIsAWarning) {
  std::vector<Vec3> points;
  for (int x = 0; x < 9; ++x) {
    for (int z = 0; z < 9; ++z)
      points.push_back({(x - 4) * 4e-3, -1e-3, (z - 4) * 4e-3});
  }
  const auto file = scratch_folder("many") / "many.ply";
  geometry::write_ply(file, points);
  const Result result = palpa_here(with({"touch"}, here({"--scene", asset("cube.glb"), "--points", file.string(),
                                                         "--min-points", "1", "--finger-gap", "1mm", "--json", "-"})));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(json::parse(result.out)["fingers"].size(), 64u);
  ASSERT_EQ(result.err_lines().size(), 1u) << result.err;
  EXPECT_TRUE(result.err.starts_with("palpa: warning: ")) << result.err;
  EXPECT_NE(result.err.find("81"), std::string::npos) << result.err;
}

TEST_P(Touch, TheSameBytesOnEveryRun) {
  const std::string usual = run_touch_here(here(cube_touch())).without_times;
  ASSERT_FALSE(usual.empty());
  EXPECT_EQ(run_touch(here(cube_touch())).without_times, usual) << "a second run";
  if (GetParam() == "cpu") return;  // the rest tests settings of a driver
  for (const Environment& environment : {Environment{{"LP_NUM_THREADS", "1"}},
                                         {{"LP_NUM_THREADS", "2"}},
                                         {{"LP_NATIVE_VECTOR_WIDTH", "128"}},
                                         {{"LP_NATIVE_VECTOR_WIDTH", "512"}},
                                         {{"PALPA_FORCE_STAGING", "1"}},
                                         {{"LVP_POISON_MEMORY", "1"}}}) {
    RunOptions options;
    options.environment = environment;
    EXPECT_EQ(run_touch(here(cube_touch()), 1.5e-3, 10, options).without_times, usual)
        << environment[0].first + "=" + environment[0].second;
  }
}

TEST_P(Touch, CsvListsEveryContactWithItsFinger) {
  const auto file = scratch_folder("csv") / "contacts.csv";
  const TouchReport report = run_touch_here(here(with(cube_touch(), {"--csv", file.string()})));
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  EXPECT_EQ(line, "index,x,y,z,depth,finger,solid");
  const std::vector<Vec3> points = lowered_finger();
  std::size_t row = 0;
  while (std::getline(stream, line)) {
    std::vector<std::string> cells;
    std::istringstream text(line);
    for (std::string cell; std::getline(text, cell, ',');)
      cells.push_back(cell);
    ASSERT_EQ(cells.size(), 7u);
    ASSERT_LT(row, report.contacts.size());
    EXPECT_EQ(cells[0], std::to_string(report.contacts[row]));
    EXPECT_NEAR(std::stod(cells[2]), points[report.contacts[row]].y, 1e-7);
    EXPECT_NEAR(std::stod(cells[4]), report.depths[row], 1e-9);
    EXPECT_EQ(cells[5], "0");
    EXPECT_EQ(cells[6], report.fingers[0].solid);
    ++row;
  }
  EXPECT_EQ(row, report.contacts.size());
}

INSTANTIATE_TEST_SUITE_P(Backends, Touch, testing::Values("cpu", "gpu"), [](const auto& test) { return test.param; });

TEST(TouchBackends, AgreeThatEveryObjectOfThePaperFeelsTheFinger) {
  for (const char* object : {"cube.glb", "semi-sphere.glb", "pyramid.glb", "prism.glb"}) {
    const std::vector<std::string> line{"--scene",           asset(object),   "--points",
                                        asset("finger.ply"), "--penetration", "3mm"};
    const TouchReport cpu = run_touch_here(with(line, {"--backend", "cpu"})),
                      gpu = run_touch_here(with(line, {"--backend", "gpu"}));
    EXPECT_EQ(cpu.contacts, gpu.contacts) << object;
    EXPECT_GE(cpu.contacts.size(), 15u) << object;
    ASSERT_EQ(cpu.fingers.size(), 1u) << object;
    ASSERT_EQ(gpu.fingers.size(), 1u) << object;
    EXPECT_EQ(cpu.fingers[0].indices, gpu.fingers[0].indices);
    EXPECT_LT(glm::distance(cpu.fingers[0].centroid, gpu.fingers[0].centroid), 1e-7);
  }
}

TEST(TouchSummary, SpeaksToPeople) {
  const Result result = palpa(with({"touch"}, cube_touch()));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("2163"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("1 finger"), std::string::npos) << result.out;
  EXPECT_EQ(palpa_here(with(with({"touch"}, cube_touch()), {"--quiet"})).out, "");
}

TEST(TouchSummary, SaysHowFarSkinIsFromTouchingAndNoOrder) {
  const auto folder = scratch_folder("no-touch");
  const auto summary = [&](const std::vector<Vec3>& points) {
    geometry::write_ply(folder / "points.ply", points);
    const Result result = palpa_here(
        {"touch", "--scene", asset("cube.glb"), "--points", (folder / "points.ply").string(), "--backend", "cpu"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("0 fingers"), std::string::npos) << result.out;
    EXPECT_EQ(result.out.find("order"), std::string::npos) << result.out;
    return result.out;
  };
  EXPECT_CONTAINS(summary(lowered_finger(-12e-3)), "the nearest skin is 12.0 mm away from the surface of cube\n");
  // Off an edge of its top, 3 mm beside it and 4 mm above.
  EXPECT_CONTAINS(summary({{0.023, 0.004, 0}, {0.1, 0, 0}}), "is 5.0 mm away from the surface of cube\n");
  EXPECT_CONTAINS(summary({{0.002, -0.02, 0}}), "is 18.0 mm below the surface of cube, deeper than its shell\n");
}

TEST(Touch, SkinAndSolidsInMillimetresAreWarnedOf) {
  const auto folder = scratch_folder("millimetres");
  std::vector<Vec3> finger = lowered_finger();
  for (Vec3& p : finger)
    p *= 1000.0;
  geometry::write_ply(folder / "finger.ply", finger);
  const std::vector<geometry::SceneMesh> cube{{"cube", box({-20, -40, -20}, {20, 0, 20})}};
  geometry::write_glb(folder / "cube.glb", cube);
  const Result result = palpa_here({"touch", "--scene", (folder / "cube.glb").string(), "--points",
                                    (folder / "finger.ply").string(), "--backend", "cpu"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_CONTAINS(result.err,
                  "finger.ply: its skin measures 50 m (coordinates are metres); if they are millimetres, it "
                  "measures 50 mm: multiply them by 0.001");
  EXPECT_CONTAINS(result.err,
                  "cube.glb: mesh \"cube\" measures 40 m (coordinates are metres); if they are millimetres, "
                  "it measures 40 mm");
}

TEST(TouchErrors, AStrideThatLeavesFociOutIsRefusedWithABetterOne) {
  const std::vector<std::string> line = with(with({"touch"}, cube_touch()), {"--backend", "cpu"});
  expect_failure(palpa_here(with(line, {"--stride", "5"})), 2, "give a stride such as");
  expect_failure(palpa_here(with(line, {"--foci", "12", "--stride", "3"})), 2, "give a stride such as 5");
  EXPECT_EQ(palpa_here(with(line, {"--foci", "12", "--quiet"})).exit_code, 0);
  EXPECT_EQ(palpa_here(with(line, {"--foci", "1", "--quiet"})).exit_code, 0);
  EXPECT_EQ(palpa_here(with(line, {"--foci", "64", "--quiet"})).exit_code, 0);
}

TEST(TouchErrors, RangesAreChecked) {
  const auto refused = [](const char* option, const char* value) {
    expect_failure(palpa_here(with(with({"touch"}, cube_touch()), {option, value})), 2, option);
  };
  for (const char* value : {"0", "-1mm", "nan", "inf", "1.5ms", "thick", "1e9", ""})
    refused("--delta", value);
  for (const char* value : {"0", "-5mm", "nan"})
    refused("--finger-gap", value);
  for (const char* value : {"0", "-1", "1.5", "99999999999999999999"})
    refused("--min-points", value);
  for (const char* value : {"0", "65", "ten"})
    refused("--foci", value);
  for (const char* value : {"0", "-3"})
    refused("--stride", value);
  for (const char* value : {"0", "-1ms", "1.5mm", "0.9us", "10.1"})
    refused("--dwell", value);
  refused("--method", "circle");
  refused("--penetration", "deep");
}

TEST(TouchWarnings, OfADwellThatSkinFeelsAsJumps) {
  const auto told = [](const char* dwell) {
    const Result result = palpa_here(with(with({"touch"}, cube_touch()), {"--backend", "cpu", "--dwell", dwell}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(told("50ms"), "");
  EXPECT_EQ(
      told("51ms"),
      "palpa: warning: --dwell of 51ms is long: a focus that stays in a place for more than 50ms is felt as jumps\n");
}

TEST(TouchErrors, WhatIsMissingOrTooMuch) {
  const std::string scene = asset("cube.glb"), points = asset("finger.ply");
  expect_failure(palpa_here({"touch", "--points", points}), 2, "--scene");
  expect_failure(palpa_here({"touch", "--scene", scene}), 2, "--points");
  expect_failure(palpa_here({"touch", "--scene", scene, "--depth", "d.png"}), 2, "--camera");
  expect_failure(palpa_here({"touch", "--scene", scene, "--points", points, "--depth", "d.png", "--camera", "c.toml"}),
                 2, "--depth");
  expect_failure(palpa_here({"touch", "--scene", scene, "--points", points, "--camera", "c.toml"}), 2, "--camera");
  expect_failure(
      palpa_here({"touch", "--scene", scene, "--depth", "d.png", "--camera", "c.toml", "--penetration", "3mm"}), 2,
      "--penetration");
  expect_failure(palpa_here({"touch", "--scene", scene, "--depth", "d.png", "--camera", "c.toml", "--rig", "r.toml"}),
                 2, "--rig");
  expect_failure(palpa_here({"touch", "--scene", scene, "--points", points, "--gltf-scene", "7"}), 4, "cube.glb");
}

}  // namespace
}  // namespace palpa::test
