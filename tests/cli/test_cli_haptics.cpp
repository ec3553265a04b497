// The haptics of a scene's author for one object, in `palpa touch` and `palpa run`.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// The finger model twice, a millimetre into the button and into the knob.
std::filesystem::path two_fingers(const std::filesystem::path& folder) {
  std::vector<Vec3> points;
  for (const double x : {0.0, 0.08}) {
    for (const Vec3& p : geometry::read_ply(source_file("assets/finger.ply")).positions)
      points.push_back(p + Vec3(x, -0.001, 0));
  }
  geometry::write_ply(folder / "fingers.ply", points);
  return folder / "fingers.ply";
}

/// The example's scene with other wishes for its knob.
std::filesystem::path with_knob(const std::filesystem::path& folder, const geometry::Haptics& haptics) {
  auto meshes = geometry::load_gltf(source_file("assets/button-and-knob.glb")).meshes;
  meshes.at(1).haptics = haptics;
  geometry::write_glb(folder / "scene.glb", meshes);
  return folder / "scene.glb";
}

TEST(CliHaptics, AFingerCarriesTheScheduleItsSolidAsksFor) {
  const auto folder = scratch_folder("haptics");
  geometry::Haptics own;
  own.foci = 8;
  own.dwell_s = 0.002;
  own.intensity = 0.7;
  const std::string scene = with_knob(folder, own).string(), points = two_fingers(folder).string();
  for (const char* backend : {"gpu", "cpu"}) {
    const Result result = palpa({"touch", "--scene", scene, "--points", points, "--backend", backend, "--json", "-"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json touch = json::parse(result.out);
    ASSERT_EQ(touch["fingers"].size(), 2U);
    EXPECT_EQ(touch["schedule"]["order"], (json{0, 3, 6, 9, 2, 5, 8, 1, 4, 7}));
    const json &button = touch["fingers"][0], &knob = touch["fingers"][1];
    EXPECT_EQ(button["solid"], "button");
    EXPECT_EQ(button["foci_m"].size(), 10U);
    EXPECT_FALSE(button.contains("schedule"));
    EXPECT_EQ(button["gain"], 0.5);
    EXPECT_EQ(knob["solid"], "knob");
    EXPECT_EQ(knob["foci_m"].size(), 8U);
    EXPECT_EQ(knob["schedule"], (json{{"order", {0, 3, 6, 1, 4, 7, 2, 5}}, {"dwell_s", 0.002}}));
    EXPECT_EQ(knob["gain"], 0.7);

    // Slot 2 of 1.5 ms: the button's third focus, the knob's second.
    const std::string file = (folder / "touch.json").string();
    std::ofstream(file) << result.out;
    const Result drive =
        palpa_here({"drive", "--layout", "paper", "--touch", file, "--slot", "2", "--backend", backend, "--json", "-"});
    ASSERT_EQ(drive.exit_code, 0) << drive.err;
    EXPECT_EQ(json::parse(drive.out)["gains"], (json{0.5, 0.7}));
    using Place = std::array<float, 3>;
    EXPECT_EQ(json::parse(drive.out)["foci_m"].get<std::vector<Place>>(),
              (std::vector<Place>{button["foci_m"][6], knob["foci_m"][3]}));
  }
}

TEST(CliHaptics, WarnsOfClicksAndTexturesThatAreNotFeltAsIntended) {
  const auto folder = scratch_folder("haptics-feel");
  const std::string points = two_fingers(folder).string();
  const auto warnings = [&](const geometry::Haptics& knob, const std::vector<std::string>& more = {}) {
    const Result result = palpa_here(
        with({"touch", "--scene", with_knob(folder, knob).string(), "--points", points, "--backend", "cpu"}, more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(warnings({}), "");
  geometry::Haptics loud;
  loud.press_depth_m = 0.003;
  loud.click.emplace();
  EXPECT_CONTAINS(warnings(loud),
                  "scene.glb: mesh \"knob\" has a gain of 1 at its press depth, so 20 ms of silence come");
  loud.intensity = 0.5;
  EXPECT_EQ(warnings(loud), "");
  EXPECT_EQ(warnings(loud, {"--dwell", "2ms"}), "");
  EXPECT_CONTAINS(warnings(loud, {"--dwell", "2.49ms"}),
                  "drives of 2.49 ms are too long for them: give a dwell of at most 2 ms");
  geometry::Haptics rough;
  rough.texture = {1, 1, 0};
  EXPECT_EQ(warnings(rough, {"--dwell", "4ms"}).find("knob"), std::string::npos) << "30 Hz have room";
}

TEST(CliHaptics, StiffnessIsTheGainOfATouch) {
  const auto folder = scratch_folder("haptics-stiffness");
  geometry::Haptics soft;
  soft.stiffness = std::vector<geometry::DepthForce>{{0, 0}, {0.004, 1}};
  const Result result = palpa_here({"touch", "--scene", with_knob(folder, soft).string(), "--points",
                                    two_fingers(folder).string(), "--backend", "cpu", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NEAR(json::parse(result.out)["fingers"][1]["gain"].get<double>(), 0.5, 0.01) << "1 mm of 4 mm: a quarter";
}

TEST(CliHaptics, AStrideThatLeavesFociOutIsNamedWithOneThatWouldDo) {
  const auto folder = scratch_folder("haptics-bad");
  geometry::Haptics nine;
  nine.foci = 9;
  const std::string scene = with_knob(folder, nine).string(), points = two_fingers(folder).string();
  const std::string fault = "node 'knob': stride 3 and 9 foci share the divisor 3";
  const std::vector<std::string> touch{"touch", "--scene", scene, "--points", points, "--backend", "cpu"};
  expect_failure(palpa_here(with(touch, {"--stride", "3"})), 4, fault);
  expect_failure(palpa_here(with(touch, {"--stride", "3"})), 4, "such as 2");
  expect_failure(palpa_here({"run", "--scene", scene, "--frames", "3", "--stride", "3"}), 4, fault);
  EXPECT_EQ(palpa_here(with(touch, {"--stride", "7"})).exit_code, 0);
  const Result usual = palpa_here(with(touch, {"--json", "-"}));
  ASSERT_EQ(usual.exit_code, 0) << usual.err;
  EXPECT_EQ(json::parse(usual.out)["fingers"][1]["schedule"]["order"], (json{0, 2, 4, 6, 8, 1, 3, 5, 7}));
}

}  // namespace
}  // namespace palpa::test
