// `palpa touch` with the paper's finger and cube: the contract's JSON, its numbers against an independent computation,
// and the same answer on every backend and under every setting of the driver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "cli/support/cube_touch.hpp"
#include "cli/support/here.hpp"
#include "cli/support/told.hpp"
#include "cli/support/touch_json.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// The finger as --penetration 3mm places it on an object whose top is at y = 0.
std::vector<Vec3> lowered_finger(double penetration = 3e-3) {
  std::vector<Vec3> points = geometry::read_ply(asset_file("finger.ply")).positions;
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

/// A line of points and the cube.
std::vector<std::string> touch_of(const std::vector<Vec3>& points, const std::string& backend = "cpu") {
  const std::string file = scratch_folder("touch") / "points.ply";
  geometry::write_ply(file, points);
  return {"touch", "--scene", asset_file("cube.glb"), "--points", file, "--backend", backend};
}

class Touch : public testing::TestWithParam<std::string> {};

TEST_P(Touch, ContactsOnTheCubeAreThoseOfEquationOne) {
  const std::string table = scratch_folder("touch") / "contacts.csv";
  const TouchReport report = run_touch_here(cube_touch({"--csv", table}, GetParam()));
  const std::vector<Vec3> points = lowered_finger();
  EXPECT_EQ(report.points, points.size());
  std::istringstream csv(read_text(table));
  std::string row;
  std::getline(csv, row);
  EXPECT_EQ(row, "index,x,y,z,depth,finger,solid");
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
    std::getline(csv, row);
    std::istringstream numbers(row);
    double index = 0, x = 0, y = 0, z = 0, in_table = 0;
    char comma = 0;
    numbers >> index >> comma >> x >> comma >> y >> comma >> z >> comma >> in_table;
    EXPECT_EQ(index, i);
    EXPECT_LT(glm::distance(Vec3(x, y, z), points[i]), 1e-7);
    EXPECT_NEAR(in_table, report.depths[at], 1e-9);
    EXPECT_TRUE(row.ends_with(",0,cube")) << row;
    sum += points[i];
    ++at;
  }
  EXPECT_EQ(at, report.contacts.size());
  EXPECT_FALSE(std::getline(csv, row)) << row;
  ASSERT_EQ(report.fingers.size(), 1u);
  EXPECT_EQ(report.fingers[0].solid, "cube");
  EXPECT_EQ(report.fingers[0].indices, report.contacts);
  EXPECT_LT(glm::distance(report.fingers[0].centroid, sum / static_cast<double>(at)), 1e-6);
}

TEST_P(Touch, FewPointsGiveFiniteNumbers) {
  for (const std::vector<Vec3>& points : {std::vector<Vec3>{}, {{0, -1e-3, 0}}, std::vector<Vec3>(4, {0, -1e-3, 0})}) {
    // Reading the report fails on any null where a number must be.
    const TouchReport report = run_touch_here(with(touch_of(points, GetParam()), {"--min-points", "1"}));
    ASSERT_EQ(report.fingers.size(), points.empty() ? 0u : 1u) << points.size();
    EXPECT_EQ(report.contacts.size(), points.size());
    for (const TouchFinger& finger : report.fingers)
      EXPECT_LT(glm::distance(finger.centroid, points[0]), 1e-6);
  }
  EXPECT_EQ(run_touch_here(with(touch_of({}, GetParam()), {"--penetration", "3mm"})).points, 0u);
}

TEST_P(Touch, TheSameBytesOnEveryRunAndUnderEverySettingOfTheDriver) {
  const std::string usual = run_touch_here(cube_touch({}, GetParam())).without_times;
  ASSERT_FALSE(usual.empty());
  std::vector<Environment> settings{{}};
  if (GetParam() == "gpu")
    settings.insert(settings.end(), {{{"LP_NUM_THREADS", "1"}},
                                     {{"LP_NUM_THREADS", "2"}},
                                     {{"LP_NATIVE_VECTOR_WIDTH", "128"}},
                                     {{"LP_NATIVE_VECTOR_WIDTH", "512"}},
                                     {{"PALPA_FORCE_STAGING", "1"}},
                                     {{"LVP_POISON_MEMORY", "1"}}});
  for (const Environment& environment : settings) {
    SCOPED_TRACE(testing::PrintToString(environment));
    const Result result = succeeded(palpa(cube_touch({"--json", "-"}, GetParam()), {.environment = environment}));
    EXPECT_EQ(read_touch(result.out).without_times, usual);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Touch, testing::Values("cpu", "gpu"), [](const auto& test) { return test.param; });

TEST(TouchOnHost, WarnsOfMoreThan64Fingers) {
  std::vector<Vec3> points;
  for (int x = 0; x < 9; ++x) {
    for (int z = 0; z < 9; ++z)
      points.push_back({(x - 4) * 4e-3, -1e-3, (z - 4) * 4e-3});
  }
  expect_warned(with(touch_of(points), {"--min-points", "1", "--finger-gap", "1mm"}), {{{}, "81"}});
}

TEST(TouchSummary, SpeaksToPeople) {
  const Result result = succeeded(palpa_here(cube_touch()));
  EXPECT_EQ(result.err, "");
  EXPECT_CONTAINS(result.out, "2163");
  EXPECT_CONTAINS(result.out, "1 finger");
  EXPECT_EQ(palpa_here(cube_touch({"--quiet"})).out, "");
}

TEST(TouchSummary, SaysHowFarSkinIsFromTouchingAndNoOrder) {
  const auto summary = [&](const std::vector<Vec3>& points) {
    const Result result = succeeded(palpa_here(touch_of(points)));
    EXPECT_CONTAINS(result.out, "0 fingers");
    EXPECT_EQ(result.out.find("order"), std::string::npos) << result.out;
    return result.out;
  };
  EXPECT_CONTAINS(summary(lowered_finger(-12e-3)), "the nearest skin is 12.0 mm away from the surface of cube\n");
  // Off an edge of its top, 3 mm beside it and 4 mm above.
  EXPECT_CONTAINS(summary({{0.023, 0.004, 0}, {0.1, 0, 0}}), "is 5.0 mm away from the surface of cube\n");
  EXPECT_CONTAINS(summary({{0.002, -0.02, 0}}), "is 18.0 mm below the surface of cube, deeper than its shell\n");
}

TEST(TouchLine, IsWarnedOfWhatIsHardlyMeant) {
  expect_warned(
      cube_touch({"--dwell"}),
      {{{"50ms"}, ""},
       {{"51ms"}, "--dwell of 51ms is long: a focus that stays in a place for more than 50ms is felt as jumps\n"},
       {{"2ms", "--foci", "64"}, ""}});
  // Millimetres.
  std::vector<Vec3> finger = lowered_finger();
  for (Vec3& p : finger)
    p *= 1000.0;
  std::vector<std::string> line = touch_of(finger);
  line[2] = scratch_folder("millimetres") / "cube.glb";
  geometry::write_glb(line[2], std::vector<geometry::SceneMesh>{{"cube", box({-20, -40, -20}, {20, 0, 20})}});
  const Result result = succeeded(palpa_here(line));
  EXPECT_CONTAINS(result.err,
                  "points.ply: its skin measures 50 m (coordinates are metres); if they are millimetres, it "
                  "measures 50 mm: multiply them by 0.001");
  EXPECT_CONTAINS(result.err,
                  "cube.glb: mesh \"cube\" measures 40 m (coordinates are metres); if they are millimetres, "
                  "it measures 40 mm");
}

/// With --audible, foci are played as a run on the layout's own boards plays them.
json audible_touch(const std::vector<std::string>& more, const std::string& told = "") {
  const Result result = succeeded(palpa_here(with(cube_touch({"--audible", "--json", "-"}), more)));
  if (told.empty()) {
    EXPECT_EQ(result.err, "");
  } else {
    EXPECT_CONTAINS(result.err, told);
  }
  return json::parse(result.out);
}

TEST(TouchAudible, StillFociHaveTheSlotsThatTheirBoardsPlay) {
  const std::vector<std::string> still{"--method", "single-focus", "--layout"};
  const auto dwell_of = [](const json& report) { return report["schedule"]["dwell_s"].get<double>(); };
  const json usual = audible_touch(with(still, {"openmpd"}));
  EXPECT_EQ(dwell_of(usual), 0.3e-3);
  EXPECT_EQ(usual["audible_dba"], audible_touch(with(still, {"openmpd", "--dwell", "0.3ms"}))["audible_dba"]);
  const json coarse = audible_touch(with(still, {"openmpd", "--dwell", "1.5ms"}));
  for (const int end : {0, 1})
    EXPECT_GT(coarse["audible_dba"][end].get<double>(), usual["audible_dba"][end].get<double>() + 3);
  EXPECT_EQ(dwell_of(audible_touch(with(still, {"openmpd", "--steps", "off"}))), 1.5e-3);
  EXPECT_EQ(dwell_of(audible_touch(with(still, {"paper"}))), 1.5e-3) << "units that modulate by their own clock";
  EXPECT_EQ(dwell_of(audible_touch({"--layout", "openmpd"})), 1.5e-3) << "foci that move";
}

TEST(TouchAudible, SaysWhereThereAreFewerSteps) {
  const std::vector<std::string> openmpd{"--layout", "openmpd", "--dwell"};
  audible_touch(with(openmpd, {"0.25ms"}),
                "--audible: phases jump from drive to drive, because a dwell of 0.25 ms has");
  audible_touch(with(openmpd, {"0.25ms", "--steps", "off"}));
  audible_touch(with(openmpd, {"3ms"}), "in the first 1.4 ms of a dwell of 3 ms, because silence must not wait longer");
}

TEST(TouchAudible, ALongDwellHasALevelToo) {
  const auto level_of = [](const std::string& dwell, const std::string& told) {
    return audible_touch({"--layout", "openmpd", "--steps", "off", "--dwell", dwell}, told)["audible_dba"];
  };
  const json at_20 = level_of("20ms", ""), at_80 = level_of("80ms", "--dwell of 80ms is long");
  for (const int end : {0, 1})
    EXPECT_NEAR(at_20[end].get<double>() - at_80[end].get<double>(), 10 * std::log10(4.0), 0.1) << end;
}

TEST(TouchAudible, ASlowLineMovesNoFoci) {
  const json one =
      audible_touch({"--layout", "sonicsurface"},
                    "--layout sonicsurface: takes 11.3 ms for each focus, longer than the dwell of 1.5 ms, "
                    "so palpa plays --method single-focus");
  EXPECT_EQ(one["fingers"][0]["foci_m"].size(), 1u);
  EXPECT_EQ(one["audible_dba"], audible_touch({"--layout", "sonicsurface", "--method", "single-focus"})["audible_dba"]);
  EXPECT_EQ(audible_touch({"--layout", "sonicsurface", "--dwell", "12ms"})["fingers"][0]["foci_m"].size(), 10u);
  expect_failure(
      palpa_here(cube_touch({"--audible", "--layout", "sonicsurface", "--method", "cross-section"})), 2,
      "--audible: SonicSurface boards take 11.3 ms for each focus, so a dwell of 1.5 ms is too short for foci "
      "that move; use --dwell 12ms, or --method single-focus");
}

}  // namespace
}  // namespace palpa::test
