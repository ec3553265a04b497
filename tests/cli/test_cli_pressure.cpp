// The loudness of foci: `palpa touch --layout`, the requested pressure, and what a run's or an export's drives give.
// And the other haptics of a scene's author for one object.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "array/field/directivity.hpp"
#include "array/layouts/board_mesh.hpp"
#include "array/layouts/layout.hpp"
#include "cli/support/boxes.hpp"
#include "cli/support/cube_touch.hpp"
#include "cli/support/drive_here.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/record_still.hpp"
#include "cli/support/report.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

array::Layout posed(const std::string& name) {
  const array::Layout layout = array::load_layout(name);
  return array::transformed(layout, layout.default_T_world_layout);
}

Vec3 point(const json& three) {
  return {three[0].get<double>(), three[1].get<double>(), three[2].get<double>()};
}

/// What the paper's q_k gives at its focus: every transducer arrives in phase.
double alone_pa(const array::Layout& layout, const Vec3& focus) {
  double reach = 0, sum = 0;
  for (const auto& [place, axis] : layout.transducers)
    reach = std::max(reach, glm::distance(place, focus));
  for (const auto& [place, axis] : layout.transducers) {
    const Vec3 way = focus - place;
    const double d = glm::length(way);
    sum += d / reach * array::directivity(array::Directivity::t4010a1, glm::dot(way, axis) / d, 0) / d;
  }
  return layout.source_level_pa_m * sum;
}

TEST(CliPressure, ATouchTellsWhatAnArrayGivesAtItsFociAndNoneOfAnEmptySector) {
  EXPECT_FALSE(report_of(cube_touch({}))["fingers"][0].contains("pressure_pa"));
  const array::Layout layout = posed("openmpd");
  // A pyramid's point in a fingertip: half of the narrow sectors have no contacts.
  const json touched = report_of({"touch", "--scene", asset_file("pyramid.glb"), "--points", asset_file("finger.ply"),
                                  "--penetration", "3mm", "--backend", "cpu", "--layout", "openmpd", "--amplitude",
                                  "distance", "--foci", "40", "--min-points", "1"});
  ASSERT_EQ(touched["fingers"].size(), 1u);
  const json &foci = touched["fingers"][0]["foci_m"], &pressures = touched["fingers"][0]["pressures_pa"];
  ASSERT_EQ(pressures.size(), 40u);
  double least = 1e9;
  std::size_t empty = 0;
  for (std::size_t j = 0; j < 40; ++j) {
    ASSERT_EQ(pressures[j].is_null(), foci[j].is_null()) << j;
    if (foci[j].is_null()) {
      ++empty;
      continue;
    }
    const double expected = alone_pa(layout, point(foci[j]));
    EXPECT_NEAR(pressures[j].get<double>(), expected, 1e-4 * expected) << j;
    least = std::min(least, pressures[j].get<double>());
  }
  EXPECT_TRUE(empty > 0 && empty < 40) << empty;
  EXPECT_EQ(touched["fingers"][0]["pressure_pa"], least);
}

/// A file of points: those of the finger model, once for each tip.
std::string fingers_at(const std::filesystem::path& file, const std::vector<Vec3>& tips) {
  std::vector<Vec3> points;
  for (const Vec3& tip : tips) {
    for (const Vec3& place : geometry::read_ply(asset_file("finger.ply")).positions)
      points.push_back(place + tip);
  }
  geometry::write_ply(file, points);
  return file;
}

const Vec3 left_tip(-0.015, -3e-3, 0), right_tip(0.015, -3e-3, 0);

/// Fingers at rest, tips at these places, before the paper's rig: a recording of three frames without noise.
std::string film(const std::vector<Vec3>& tips) {
  const std::filesystem::path folder = scratch_folder("film-of-" + std::to_string(tips.size())) / "take";
  const geometry::Ply ply = geometry::read_ply(asset_file("finger.ply"));
  const geometry::Mesh finger{ply.positions, ply.triangles};
  sensing::SyntheticRig cameras(sensing::load_rig(asset_file("rigs/paper.toml")).cameras,
                                array::board_mesh(posed("paper")), sensing::Noise::none, 1);
  std::vector<sensing::Posed> hand;
  for (const Vec3& tip : tips) {
    Transform T(1.0);
    T[3] = Vec4(tip, 1);
    hand.push_back({&finger, T});
  }
  return record_still(folder, cameras.cameras(), cameras, hand, {0, 1 / 90.0, 2 / 90.0});
}
const std::string& film_of_two() {
  static const std::string take = film({left_tip, right_tip});
  return take;
}

/// Two boxes side by side, tops at y = 0, 30 mm from middle to middle, each as its haptics say.
std::string two_boxes(const geometry::Haptics& left, const geometry::Haptics& right) {
  std::vector<geometry::SceneMesh> meshes;
  for (const double side : {-1.0, 1.0}) {
    meshes.push_back(make_box({.name = side < 0 ? "left" : "right",
                               .on_face = {0.015 * side, 0, 0},
                               .normal = {0, 1, 0},
                               .along = {1, 0, 0},
                               .half_along = 0.0145,
                               .half_across = 0.0145,
                               .depth = 0.03}));
    meshes.back().haptics = side < 0 ? left : right;
  }
  const std::string file = (scratch_folder("pressure-scene") / "boxes.glb").string();
  geometry::write_glb(file, meshes);
  return file;
}

/// What is exported of still fingers: those of the newest frame of foci, the drives, the stats, the summary, the
/// warnings of pressures.
struct Played {
  json fingers, stats;
  std::filesystem::path drives;
  std::string told;
  std::vector<std::string> warnings;
};

Played play(const std::string& scene, const std::string& take, const std::vector<std::string>& more) {
  const auto folder = scratch_folder("pressure-played");
  const std::string foci = folder / "foci.json", drives = folder / "drives.bin";
  const Result result = succeeded(palpa_here(with({"export", "--scene", scene, "--source", take, "--foci", foci,
                                                   "--drives", drives, "--json", folder / "stats.json"},
                                                  more)));
  Played played{.fingers = {},
                .stats = json::parse(read_text(folder / "stats.json")),
                .drives = drives,
                .told = result.out,
                .warnings = result.err_lines()};
  std::erase_if(played.warnings, [](const std::string& line) { return line.find(" Pa of the ") == std::string::npos; });
  const json frames = json::parse(read_text(foci))["frames"];
  for (const json& frame : frames) {
    if (!frame["fingers"].empty()) played.fingers = frame["fingers"];
  }
  return played;
}

/// |p| of a drive, from its bytes and nothing else of palpa's but where transducers are and how they sound to the side.
double pressure_of(const array::Layout& layout, const array::Drive& drive, const Vec3& point) {
  const double k = 2 * std::numbers::pi * 40e3 / (331.3 * std::sqrt(1 + 20 / 273.15));
  std::complex<double> sum = 0;
  for (std::size_t n = 0; n < drive.size(); ++n) {
    const auto& [place, axis] = layout.transducers[n];
    const Vec3 way = point - place;
    const double d = glm::length(way);
    sum +=
        std::polar(drive[n].amplitude * array::directivity(array::Directivity::t4010a1, glm::dot(way, axis) / d, 0) / d,
                   drive[n].phase + k * d);
  }
  return layout.source_level_pa_m * std::abs(sum);
}

/// The slots in which something sounds.
std::vector<RecordedDrive> sounding(const std::filesystem::path& drives) {
  std::vector<RecordedDrive> loud = read_to_silence(drives).drives;
  std::erase_if(loud, [](const RecordedDrive& one) { return loudest(one.drive) == 0; });
  EXPECT_FALSE(loud.empty());
  return loud;
}

/// The least and the most that one finger's focus has in the slots in which it sounds.
std::pair<double, double> heard(const array::Layout& layout, const Played& played, std::size_t finger) {
  const json& f = played.fingers.at(finger);
  double least = 1e9, most = 0;
  for (const auto& [slot, drive] : sounding(played.drives)) {
    const auto& step = f["order"][slot % f["order"].size()];
    for (const auto& focus : step.is_array() ? step : json::array({step})) {
      const double pressure = pressure_of(layout, drive, point(f["foci_m"][focus.get<std::size_t>()]));
      least = std::min(least, pressure);
      most = std::max(most, pressure);
    }
  }
  return {least, most};
}

void expect_heard(const array::Layout& layout, const Played& played, std::size_t finger, double pascals) {
  const auto [least, most] = heard(layout, played, finger);
  EXPECT_NEAR(least, pascals, 0.01 * pascals);
  EXPECT_NEAR(most, pascals, 0.01 * pascals);
  EXPECT_NEAR(played.fingers[finger]["pressure_pa"], pascals, 0.01 * pascals);
}

class PressureOn : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Backends, PressureOn, testing::Values("cpu", "gpu"),
                         [](const auto& test) { return test.param; });

TEST_P(PressureOn, TwoFingersEachHaveWhatOneAloneHas) {
  const Played both = play(two_boxes({}, {}), film_of_two(), {"--backend", GetParam(), "--pressure", "8kPa"});
  ASSERT_EQ(both.fingers.size(), 2u);
  for (const std::size_t finger : {0u, 1u})
    expect_heard(posed("paper"), both, finger, 8e3);
  EXPECT_EQ(both.warnings, std::vector<std::string>{});
}

TEST(CliPressure, ARunTellsWhatItsFingersHave) {
  const Result result =
      succeeded(palpa_here({"run", "--scene", two_boxes({}, {}), "--source", film_of_two(), "--every-frame",
                            "--backend", "cpu", "--pressure", "8kPa", "--json", "-"}));
  const json fingers = json::parse(result.out)["fingers"];
  ASSERT_EQ(fingers.size(), 2u);
  EXPECT_EQ(fingers[0]["solid"], "left");
  EXPECT_NEAR(fingers[0]["pressure_pa"]["least"], 8e3, 80);
}

TEST(CliPressure, AnUnreachableOneLowersNobodyElse) {
  geometry::Haptics modest, greedy;
  modest.pressure_pa = 10e3;
  modest.intensity = 0.5;
  greedy.pressure_pa = 1e5;
  const Played both = play(two_boxes(modest, greedy), film_of_two(), {"--backend", "cpu"});
  ASSERT_EQ(both.fingers.size(), 2u);
  const double reached = both.fingers[1]["pressure_pa"];
  EXPECT_LT(reached, 5e4);
  EXPECT_GT(reached, 2e4) << "it has what is left";
  expect_heard(posed("paper"), both, 0, 5e3);
  expect_heard(posed("paper"), both, 1, reached);
  ASSERT_EQ(both.warnings.size(), 1u) << "said once";
  EXPECT_CONTAINS(both.warnings[0], "on right has");
  EXPECT_EQ(both.stats["fingers"][1]["asked_pa"], 1e5);
  EXPECT_CONTAINS(both.told, "of the 100000 Pa asked for");
}

TEST(CliNulls, OfFramesLieInTheWorld) {
  const array::Layout layout = posed("openmpd");
  const std::string drives = scratch_folder("nulls-run") / "drives.bin";
  succeeded(palpa_here({"run", "--scene", two_boxes({}, {}), "--source", film({left_tip}), "--every-frame", "--backend",
                        "cpu", "--layout", "openmpd", "--null", "30mm,10mm,0", "--hold", "1s", "--link",
                        "record:" + drives}));
  for (const auto& [slot, drive] : sounding(drives)) {
    // Near the tip it sounds a thousand times louder.
    EXPECT_LT(1e3 * pressure_of(layout, drive, {0.03, 0.01, 0}), pressure_of(layout, drive, left_tip)) << slot;
  }
}

// Foci are known only while it runs: it warns of them as `palpa drive` does.
TEST(CliNulls, OfARunAreDoubtedAsThoseOfADrive) {
  const auto warnings = [&](const std::string& null) {
    const Result result =
        succeeded(palpa_here({"run", "--scene", two_boxes({}, {}), "--source", film({left_tip}), "--every-frame",
                              "--backend", "cpu", "--layout", "openmpd", "--null", null}));
    return result.err;
  };
  EXPECT_EQ(warnings("30mm,10mm,0").find("--null"), std::string::npos);
  const auto comes_once = [](const std::string& err, const std::string& told) {
    const std::size_t first = err.find(told);
    EXPECT_NE(first, std::string::npos) << err;
    EXPECT_EQ(err.find(told, first + 1), std::string::npos) << err;
  };
  comes_once(warnings("-15mm,0,0"), "closer than the array resolves there: they share");  // within the ring
  const std::string at_a_focus = warnings("-11mm,-1mm,-3.5mm");
  comes_once(at_a_focus, "palpa: warning: --null: null 1 is ");
  comes_once(at_a_focus, "of the pressure that it has without nulls; this warning comes once");
  comes_once(warnings("-11mm,-1mm,-3.5mm,4mm"), "is within null 1, ");
}

TEST_P(PressureOn, ADriveOfATouchHasWhatItsFingersAsked) {
  geometry::Haptics asks;
  asks.pressure_pa = 800;
  asks.intensity = 0.5;
  const std::filesystem::path folder = scratch_folder("asked");
  const std::string file = folder / "touch.json", scene = two_boxes({}, asks),
                    points = fingers_at(folder / "fingers.ply", {left_tip, right_tip});
  const auto touch_of = [&](const std::vector<std::string>& more) {
    const json touch = report_of(with({"touch", "--scene", scene, "--points", points, "--backend", GetParam()}, more));
    write_text(file, touch.dump());
    return touch["fingers"];
  };
  const auto heard = [&](const std::vector<std::string>& more) {
    const Result result = succeeded(palpa_here(
        with({"drive", "--layout", "openmpd", "--touch", file, "--backend", GetParam(), "--json", "-"}, more)));
    return json::parse(result.out)["pressures_pa"].get<std::vector<double>>();
  };
  json fingers = touch_of({});
  ASSERT_EQ(fingers.size(), 2u);
  const std::size_t right = fingers[0]["solid"] == "right" ? 0 : 1, left = 1 - right;
  EXPECT_EQ(fingers[right]["asked_pa"], 400) << "times its intensity";
  EXPECT_FALSE(fingers[left].contains("asked_pa"));
  const std::vector<double> in_a_slot = heard({"--slot", "2"}), by_the_option = heard({"--pressure", "300Pa"});
  EXPECT_NEAR(in_a_slot.at(right), 400, 1);
  EXPECT_GT(in_a_slot.at(left), 1000) << "it asks for no pressure and gets the rest";
  EXPECT_NEAR(by_the_option.at(left), 300, 1) << "the solid asks for none";
  EXPECT_NEAR(by_the_option.at(right), 400, 1) << "a solid's pressure takes precedence over the option's";

  fingers = touch_of({"--layout", "openmpd", "--pressure", "300Pa", "--method", "multi-focus"});
  EXPECT_EQ(fingers[left]["asked_pa"], 300);
  EXPECT_EQ(fingers[right]["asked_pa"], 400);
  const std::vector<double> together = heard({});
  ASSERT_GT(together.size(), 10u);
  for (const double pascals : together)
    EXPECT_TRUE(std::abs(pascals - 300) < 3 || std::abs(pascals - 400) < 4) << pascals;
}

TEST(CliPressure, ATouchHasItAndWhoAsksForNextToNothingLacksNothing) {
  const json touched = report_of(cube_touch({"--layout", "openmpd", "--pressure", "1.5kPa"}));
  const json& pressures = touched["fingers"][0]["pressures_pa"];
  EXPECT_EQ(pressures.size(), 10u);
  for (const json& pressure : pressures)
    EXPECT_NEAR(pressure, 1500, 15);
  EXPECT_EQ(palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,150mm,1e-30", "--pressure", "2kPa", "--backend",
                        "cpu"})
                .err,
            "");
}

TEST(CliPressure, AboveTenKilopascalsLinearAcousticsEnds) {
  const std::vector<std::string> drive{"drive", "--focus", "0,0,150mm", "--backend", "cpu", "--layout"};
  const std::pair<std::vector<std::string>, bool> lines[]{
      {cube_touch({"--layout", "paper", "--pressure", "12kPa"}), true},
      {cube_touch({"--layout", "paper", "--pressure", "9kPa"}), false},
      {with(drive, {"openmpd"}), false},
      {with(drive, {"paper", "--focus", "0,0,0"}), true},
      {with(drive, {"paper", "--pressure", "9kPa"}), false},
      {with(drive, {"paper", "--pressure", "11kPa"}), true}};
  for (const auto& [line, beyond] : lines) {
    const Result result = succeeded(palpa_here(line));
    EXPECT_EQ(result.out.find("above 10 kPa, linear acoustics no longer holds") != std::string::npos, beyond)
        << result.out;
  }
}

class CliHaptics : public testing::Test {
 protected:
  /// The example's scene with other wishes for its knob, and the finger model twice, a millimetre into the button and
  /// into the knob.
  std::vector<std::string> touch_with(const geometry::Haptics& knob, const std::string& backend = "cpu") const {
    auto meshes = geometry::load_gltf(asset_file("button-and-knob.glb")).meshes;
    meshes.at(1).haptics = knob;
    geometry::write_glb(scene_, meshes);
    const std::string fingers = fingers_at(folder_ / "fingers.ply", {{0, -0.001, 0}, {0.08, -0.001, 0}});
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
    const json touch = report_of(touch_with(own, backend));
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
  const json touch = report_of(touch_with(soft));
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
    const Result result = succeeded(palpa_here(with(touch_with(knob), options)));
    EXPECT_EQ(result.err.find("knob") == std::string::npos, told.empty()) << result.err;
    EXPECT_CONTAINS(result.err, told);
  }
}

}  // namespace
}  // namespace palpa::test
