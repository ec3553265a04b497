// The loudness of foci: `palpa touch --layout`, and the requested pressure, in the real program.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "array/directivity.hpp"
#include "array/layouts/board_mesh.hpp"
#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "cli/support/boxes.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "session/links/record_link.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/udp_receiver.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

std::vector<std::string> touch(const std::vector<std::string>& more) {
  return with({"touch", "--scene", asset("cube.glb"), "--points", asset("finger.ply"), "--penetration", "3mm",
               "--backend", "cpu"},
              more);
}

json document(const std::vector<std::string>& more) {
  const Result result = palpa_here(with(touch(more), {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return json::parse(result.out);
}

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

TEST(CliPressure, ATouchTellsWhatAnArrayGivesAtItsFoci) {
  const json bare = document({});
  EXPECT_FALSE(bare["fingers"][0].contains("pressure_pa"));
  for (const std::string name : {"paper", "openmpd"}) {
    const array::Layout layout = posed(name);
    const json finger = document({"--layout", name})["fingers"][0];
    EXPECT_EQ(finger["foci_m"], bare["fingers"][0]["foci_m"]);
    const auto pressures = finger["pressures_pa"].get<std::vector<double>>();
    ASSERT_EQ(pressures.size(), 10u);
    for (std::size_t j = 0; j < pressures.size(); ++j) {
      const double expected = alone_pa(layout, point(finger["foci_m"][j]));
      EXPECT_NEAR(pressures[j], expected, 1e-4 * expected) << name << " focus " << j;
    }
    EXPECT_EQ(finger["pressure_pa"], *std::ranges::min_element(pressures));
  }
}

TEST(CliPressure, OfAnEmptySectorThereIsNone) {
  // A pyramid's point in a fingertip: half of the narrow sectors have no contacts.
  const Result result =
      palpa_here({"touch", "--scene", asset("pyramid.glb"), "--points", asset("finger.ply"), "--penetration", "3mm",
                  "--backend", "cpu", "--layout", "openmpd", "--foci", "40", "--min-points", "1", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json touched = json::parse(result.out);
  ASSERT_EQ(touched["fingers"].size(), 1u);
  const json& finger = touched["fingers"][0];
  ASSERT_EQ(finger["pressures_pa"].size(), 40u);
  std::size_t empty = 0;
  for (std::size_t j = 0; j < 40; ++j) {
    EXPECT_EQ(finger["pressures_pa"][j].is_null(), finger["foci_m"][j].is_null());
    empty += finger["foci_m"][j].is_null() ? 1 : 0;
  }
  ASSERT_GT(empty, 0u);
  ASSERT_LT(empty, 40u);
}

/// Fingers at rest, tips at these places, before the paper's rig: a recording of twelve frames without noise.
std::string film(const std::string& name, const std::vector<Vec3>& tips) {
  const std::filesystem::path folder = scratch_folder("pressure-" + name) / "take";
  const geometry::Ply ply = geometry::read_ply(source_file("assets/finger.ply"));
  const geometry::Mesh finger{ply.positions, ply.triangles};
  sensing::SyntheticRig cameras(sensing::load_rig(asset("rigs/paper.toml")).cameras, array::board_mesh(posed("paper")),
                                sensing::Noise::none, 1);
  sensing::RecordingWriter writer(folder, cameras.cameras());
  std::vector<sensing::Posed> hand;
  for (const Vec3& tip : tips) {
    Transform T(1.0);
    T[3] = Vec4(tip, 1);
    hand.push_back({&finger, T});
  }
  sensing::FrameSet set;
  cameras.render(hand, 0, set);
  for (int frame = 0; frame < 12; ++frame) {
    set.sequence = static_cast<std::uint64_t>(frame);
    set.time_s = frame / 90.0;
    for (sensing::DepthFrame& image : set.frames)
      image.time_s = set.time_s;
    writer.write(set);
  }
  return folder.string();
}

const Vec3 left_tip(-0.015, -3e-3, 0), right_tip(0.015, -3e-3, 0);

/// Recordings of one finger and of two fingers, each made once.
const std::string& film_of_one() {
  static const std::string take = film("one", {left_tip});
  return take;
}
const std::string& film_of_two() {
  static const std::string take = film("two", {left_tip, right_tip});
  return take;
}

/// Two boxes side by side, tops at y = 0, 30 mm from middle to middle, each as its haptics say.
std::string two_boxes(const std::string& name, const geometry::Haptics& left, const geometry::Haptics& right) {
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
  const std::string file = (scratch_folder("pressure-scene-" + name) / "boxes.glb").string();
  geometry::write_glb(file, meshes);
  return file;
}

/// What `palpa run` plays to a still hand: the fingers of its newest line of foci, its drives, its stats.
struct Played {
  json fingers, stats;
  session::DriveRecording drives;
  std::vector<std::string> warnings;
};

Played play(const std::string& scene, const std::string& take, const std::vector<std::string>& more) {
  const std::filesystem::path file = scratch_folder("pressure-drives") / "drives.bin";
  // A long hold, so that frames that a slow machine plays late still sound.
  const auto run = [&](const std::string& link) {
    const Result result = palpa(with({"run", "--scene", scene, "--source", "recording:" + take, "--every-frame",
                                      "--hold", "1s", "--json", "-", "--link", link},
                                     more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  };
  Played played;
  const UdpReceiver receiver(std::chrono::milliseconds(50));  // the sender has ended before the first read
  Result result;
  side_by_side({[&] { result = run("record:" + file.string()); }, [&] { run("foci:" + receiver.address()); }});
  // A slow machine may also have a warning that frames come late.
  played.warnings = result.err_lines();
  std::erase_if(played.warnings, [](const std::string& line) { return line.find(" Pa of the ") == std::string::npos; });
  played.stats = json::parse(result.out);
  played.drives = session::read_drive_recording(file);
  for (std::string text; !(text = receiver.next()).empty();) {
    const json line = json::parse(text);
    if (!line["fingers"].empty()) played.fingers = line["fingers"];
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

/// The least and the most that one finger's focus has in the slots in which it sounds.
std::pair<double, double> heard(const array::Layout& layout, const Played& played, std::size_t finger) {
  const json& f = played.fingers.at(finger);
  double least = 1e9, most = 0;
  for (const auto& [slot, drive] : played.drives.drives) {
    if (std::ranges::all_of(drive, [](const auto& transducer) { return transducer.amplitude == 0; })) continue;
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

TEST(CliPressure, AFingerHasItInEverySlot) {
  const Played alone = play(two_boxes("plain", {}, {}), film_of_one(), {"--backend", "cpu", "--pressure", "8kPa"});
  ASSERT_EQ(alone.fingers.size(), 1u);
  expect_heard(posed("paper"), alone, 0, 8e3);
}

class PressureOn : public testing::TestWithParam<std::string> {};
std::string backend_of(const testing::TestParamInfo<std::string>& info) {
  return info.param;
}
INSTANTIATE_TEST_SUITE_P(Backends, PressureOn, testing::Values("cpu", "gpu"), backend_of);

TEST_P(PressureOn, TwoFingersEachHaveWhatOneAloneHas) {
  const Played both = play(two_boxes("plain", {}, {}), film_of_two(), {"--backend", GetParam(), "--pressure", "8kPa"});
  ASSERT_EQ(both.fingers.size(), 2u);
  for (const std::size_t finger : {0u, 1u})
    expect_heard(posed("paper"), both, finger, 8e3);
  EXPECT_EQ(both.warnings, std::vector<std::string>{});
  ASSERT_EQ(both.stats["fingers"].size(), 2u);
  EXPECT_EQ(both.stats["fingers"][0]["solid"], "left");
  EXPECT_NEAR(both.stats["fingers"][0]["pressure_pa"]["least"], 8e3, 80);
}

TEST(CliPressure, LeftOutTheSecondFingerTakesFromTheFirstAndNothingIsToldOfPressures) {
  const array::Layout layout = posed("paper");
  const Played loud = play(two_boxes("plain", {}, {}), film_of_two(), {"--backend", "cpu"});
  ASSERT_EQ(loud.fingers.size(), 2u);
  EXPECT_FALSE(loud.fingers[0].contains("pressure_pa"));
  EXPECT_FALSE(loud.stats.contains("fingers"));
  const auto [least, most] = heard(layout, loud, 0);
  EXPECT_GT(most / least, 1.03);
}

TEST(CliPressure, AnUnreachableOneLowersNobodyElse) {
  const array::Layout layout = posed("paper");
  geometry::Haptics modest, greedy;
  modest.pressure_pa = 10e3;
  modest.intensity = 0.5;
  greedy.pressure_pa = 1e5;
  const Played both = play(two_boxes("greedy", modest, greedy), film_of_two(), {"--backend", "cpu"});
  ASSERT_EQ(both.fingers.size(), 2u);
  expect_heard(layout, both, 0, 5e3);
  const double reached = both.fingers[1]["pressure_pa"];
  EXPECT_LT(reached, 5e4);
  EXPECT_GT(reached, 2e4) << "it has what is left";
  expect_heard(layout, both, 1, reached);
  ASSERT_EQ(both.warnings.size(), 1u) << "said once";
  EXPECT_NE(both.warnings[0].find("on right has"), std::string::npos) << both.warnings[0];
}

TEST(CliPressure, TogetherEachFocusHasItOfTheWholeSoundAndACeilingComesAfter) {
  const array::Layout layout = posed("openmpd");
  const std::string scene = two_boxes("plain", {}, {}), take = film_of_one();
  const std::vector<std::string> options{"--backend", "cpu",      "--pressure",
                                         "500Pa",     "--method", "multi-focus",
                                         "--layout",  "openmpd",  "--modulation-frequency",
                                         "0"};
  const Played full = play(scene, take, options);
  expect_heard(layout, full, 0, 500);
  const Played half = play(scene, take, with(options, {"--ceiling", "0.5"}));
  expect_heard(layout, half, 0, 250);
}

TEST(CliPressure, TouchAndDriveHaveItToo) {
  const json finger = document({"--layout", "openmpd", "--pressure", "1.5kPa"})["fingers"][0];
  for (const json& pressure : finger["pressures_pa"])
    EXPECT_NEAR(pressure, 1500, 15);
  const Result result = palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--focus",
                                    "2cm,0,150mm,0.5", "--pressure", "2kPa", "--backend", "cpu", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json drive = json::parse(result.out);
  EXPECT_NEAR(drive["pressures_pa"][0], 2000, 10);
  EXPECT_NEAR(drive["pressures_pa"][1], 1000, 5);
  for (const json& amplitude : drive["amplitudes"])
    EXPECT_LE(amplitude, 1.0);
  const Result nothing = palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,150mm,1e-30", "--pressure", "2kPa",
                                     "--backend", "cpu", "--json", "-"});
  EXPECT_EQ(nothing.err, "") << "who asks for next to nothing lacks nothing";
}

TEST_P(PressureOn, ADriveOfATouchHasWhatItsFingersAsked) {
  geometry::Haptics asks;
  asks.pressure_pa = 800;
  asks.intensity = 0.5;
  const std::filesystem::path folder = scratch_folder("asked-" + GetParam());
  const std::string file = (folder / "touch.json").string();
  // A fingertip in each of the two boxes.
  const geometry::Ply finger = geometry::read_ply(asset("finger.ply"));
  std::vector<Vec3> both;
  for (const Vec3& tip : {left_tip, right_tip}) {
    for (const Vec3& place : finger.positions)
      both.push_back(place + tip);
  }
  const std::string points = (folder / "fingers.ply").string();
  geometry::write_ply(points, both);
  const auto touch_of = [&](const std::vector<std::string>& more) {
    const Result result = palpa_here(with({"touch", "--scene", two_boxes("asked-" + GetParam(), {}, asks), "--points",
                                           points, "--backend", GetParam(), "--json", file},
                                          more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return json::parse(std::ifstream(file))["fingers"];
  };
  const auto heard = [&](const std::vector<std::string>& more) {
    const Result result = palpa_here(
        with({"drive", "--layout", "openmpd", "--touch", file, "--backend", GetParam(), "--json", "-"}, more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
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

TEST(CliPressure, AboveTenKilopascalsLinearAcousticsEnds) {
  EXPECT_NE(
      palpa_here(touch({"--layout", "paper", "--pressure", "12kPa"})).out.find("linear acoustics no longer holds"),
      std::string::npos);
  EXPECT_EQ(palpa_here(touch({"--layout", "paper", "--pressure", "9kPa"})).out.find("linear acoustics"),
            std::string::npos);
}

TEST(CliPressure, DriveSaysSoWhetherAPressureIsAskedForOrNot) {
  const auto told = [](const std::vector<std::string>& more) {
    const Result result = palpa_here(with({"drive", "--focus", "0,0,150mm", "--backend", "cpu"}, more));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.find("above 10 kPa, linear acoustics no longer holds") != std::string::npos;
  };
  EXPECT_FALSE(told({"--layout", "openmpd"}));
  EXPECT_TRUE(told({"--layout", "paper", "--focus", "0,0,0"}));
  EXPECT_FALSE(told({"--layout", "paper", "--pressure", "9kPa"}));
  EXPECT_TRUE(told({"--layout", "paper", "--pressure", "11kPa"}));
}

TEST(CliPressure, ItTakesThePlaceOfAConstraint) {
  const std::string scene = asset("cube.glb");
  expect_failure(palpa_here({"run", "--scene", scene, "--pressure", "8kPa", "--constraint", "normalise"}), 2,
                 "--constraint");
  expect_failure(palpa_here({"run", "--scene", scene, "--pressure", "8kPa", "--solver", "greedy"}), 2, "greedy");
  expect_failure(palpa_here({"run", "--scene", scene, "--pressure", "0"}), 2, "above 0");
  expect_failure(palpa_here({"run", "--scene", scene, "--pressure", "101kPa"}), 2, "100kPa");
  expect_failure(palpa_here(touch({"--pressure", "8kPa"})), 2, "--layout");
  geometry::Haptics asks;
  asks.pressure_pa = 5e3;
  const std::string asking = two_boxes("asking", {}, asks);
  expect_failure(palpa_here({"run", "--scene", asking, "--constraint", "clamp"}), 2, "\"right\" asks for a pressure");
  expect_failure(palpa_here({"run", "--scene", asking, "--solver", "greedy"}), 2, "\"right\" asks for a pressure");
}

TEST(CliPressure, HowAnArrayIsDrivenGoesWithOne) {
  expect_failure(palpa_here(touch({"--solver", "greedy"})), 2, "--layout");
  expect_failure(palpa_here(touch({"--layout", "nowhere"})), 4, "nowhere");
}

}  // namespace
}  // namespace palpa::test
