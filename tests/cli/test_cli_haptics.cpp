// The haptics of a scene's author for one object, in `palpa touch` and `palpa run`.
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/cube_touch.hpp"
#include "cli/support/drive_here.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

class CliHaptics : public testing::Test {
 protected:
  /// The example's scene with other wishes for its knob, and the finger model twice, a millimetre into the button and
  /// into the knob.
  std::vector<std::string> touch_with(const geometry::Haptics& knob, const std::string& backend = "cpu") const {
    auto meshes = geometry::load_gltf(asset_file("button-and-knob.glb")).meshes;
    meshes.at(1).haptics = knob;
    geometry::write_glb(scene_, meshes);
    std::vector<Vec3> points;
    for (const double x : {0.0, 0.08}) {
      for (const Vec3& p : geometry::read_ply(asset_file("finger.ply")).positions)
        points.push_back(p + Vec3(x, -0.001, 0));
    }
    const std::string fingers = folder_ / "fingers.ply";
    geometry::write_ply(fingers, points);
    return {"touch", "--scene", scene_, "--points", fingers, "--backend", backend};
  }

  const std::filesystem::path folder_ = scratch_folder("haptics");
  const std::string scene_ = folder_ / "scene.glb";
};

TEST_F(CliHaptics, AFingerCarriesTheScheduleItsSolidAsksFor) {
  geometry::Haptics own;
  own.foci = 8;
  own.dwell_s = 0.002;
  own.intensity = 0.7;
  for (const char* backend : {"gpu", "cpu"}) {
    const json touch = touch_report(touch_with(own, backend));
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
    const std::string file = folder_ / "touch.json";
    write_text(file, touch.dump());
    const json drive = drive_here({"--layout", "paper", "--touch", file, "--slot", "2"}, backend).report;
    EXPECT_EQ(drive["gains"], (json{0.5, 0.7}));
    using Place = std::array<float, 3>;
    EXPECT_EQ(drive["foci_m"].get<std::vector<Place>>(), (std::vector<Place>{button["foci_m"][6], knob["foci_m"][3]}));
  }
}

TEST_F(CliHaptics, StiffnessIsTheGainOfATouch) {
  geometry::Haptics soft;
  soft.stiffness = std::vector<geometry::DepthForce>{{0, 0}, {0.004, 1}};
  const json touch = touch_report(touch_with(soft));
  EXPECT_NEAR(touch["fingers"][1]["gain"].get<double>(), 0.5, 0.01) << "1 mm of 4 mm: a quarter";
}

TEST_F(CliHaptics, ClicksAndTexturesThatAreNotFeltAsIntendedAreWarnedOf) {
  geometry::Haptics loud, quiet, rough;
  loud.press_depth_m = 0.003;
  loud.click.emplace();
  quiet = loud;
  quiet.intensity = 0.5;
  rough.texture = {1, 1, 0};  // its 30 Hz have room in slow drives
  const struct {
    geometry::Haptics knob;
    std::vector<std::string> options;
    std::string told;  ///< of the knob
  } cases[]{{{}, {}, ""},
            {loud, {}, "scene.glb: mesh \"knob\" has a gain of 1 at its press depth, so 20 ms of silence come"},
            {quiet, {}, ""},
            {quiet, {"--dwell", "2ms"}, ""},
            {quiet, {"--dwell", "2.49ms"}, "drives of 2.49 ms are too long for them: give a dwell of at most 2 ms"},
            {rough, {"--dwell", "4ms"}, ""}};
  for (const auto& [knob, options, told] : cases) {
    const Result result = palpa_here(with(touch_with(knob), options));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("knob") == std::string::npos, told.empty()) << result.err;
    EXPECT_CONTAINS(result.err, told);
  }
}

TEST_F(CliHaptics, AStrideThatLeavesFociOutIsNamedWithOneThatWouldDo) {
  geometry::Haptics nine;
  nine.foci = 9;
  const std::vector<std::string> touch = touch_with(nine);
  const std::string fault = "node 'knob': stride 3 and 9 foci share the divisor 3";
  const std::vector<std::string> stride{"--stride", "3"};
  expect_failure(palpa_here(with(touch, stride)), 4, fault);
  expect_failure(palpa_here(with({"run", "--scene", scene_, "--frames", "3"}, stride)), 4, fault);
  EXPECT_EQ(palpa_here(with(touch, {"--stride", "7"})).exit_code, 0);
  EXPECT_EQ(touch_report(touch)["fingers"][1]["schedule"]["order"], (json{0, 2, 4, 6, 8, 1, 3, 5, 7}));
}

}  // namespace
}  // namespace palpa::test
