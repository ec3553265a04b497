// `palpa play`: its table, its record and its report against formulas of the test's own, its limits and refusals, and
// runs to their end.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "sensation/pattern_text.hpp"
#include "setup/sessions/play.hpp"
#include "support/csv.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::filesystem::path& folder() {
  static const std::filesystem::path folder = scratch_folder("play");
  return folder;
}

Result play(const std::string& line) {
  return palpa_here(words_of("play " + line));
}

/// The rows of --csv -.
std::vector<std::vector<double>> slots_of(const std::string& line) {
  const Result result = succeeded(play(line + " --csv - --quiet"));
  EXPECT_TRUE(result.out.starts_with("time_s,x_m,y_m,z_m,gain\n")) << result.out.substr(0, 100);
  write_text(folder() / "slots.csv", result.out);
  return read_csv(folder() / "slots.csv");
}

TEST(Play, ListsTheSlotsOfACircle) {
  const auto slots = slots_of("circle --duration 100ms --param radius=12");
  ASSERT_EQ(slots.size(), 115U);  // 0.875 ms: 16.3 in a turn of 70 Hz
  for (std::size_t s = 0; s < slots.size(); ++s) {
    const double time_s = 0.875e-3 * static_cast<double>(s), w = 2 * std::numbers::pi * 70 * time_s;
    EXPECT_NEAR(slots[s][0], time_s, 1e-12);
    EXPECT_NEAR(slots[s][1], 12e-3 * std::cos(w), 1e-9);
    EXPECT_NEAR(slots[s][2], 12e-3 * std::sin(w), 1e-9);
    EXPECT_NEAR(slots[s][3], 0.2, 1e-12);
    EXPECT_EQ(slots[s][4], 1);
  }
}

TEST(Play, PlacesAndSpeedsOfAPattern) {
  const auto own = slots_of("sweep --duration 300ms"), twice = slots_of("sweep --duration 150ms --speed 2"),
             there = slots_of("sweep --duration 300ms --at 1cm,-2cm,15cm"),
             by_parameter = slots_of("sweep --duration 150ms --param speed=2");
  ASSERT_EQ(own.size(), 480U);
  ASSERT_EQ(twice.size(), 240U);
  for (std::size_t s = 0; s < own.size(); ++s) {
    EXPECT_NEAR(there[s][1], own[s][1] + 0.01, 1e-12);
    EXPECT_NEAR(there[s][2], own[s][2] - 0.02, 1e-12);
    EXPECT_NEAR(there[s][3], 0.15, 1e-12);  // instead of the pattern's own height
    EXPECT_EQ(there[s][4], own[s][4]);
  }
  EXPECT_EQ(twice, by_parameter);
  for (std::size_t s = 0; s < twice.size(); ++s)
    EXPECT_NEAR(twice[s][2], own[2 * s][2], 1e-9);  // the way, which the brush does not change along y
}

TEST(Play, EveryOwnSensationPlaysAndIsAsItSays) {
  for (const std::string& name : setup::sensation_names()) {
    const auto slots = slots_of(name + " --duration 1s");
    double loudest = 0;
    for (const auto& slot : slots) {
      EXPECT_LE(std::hypot(slot[1], slot[2]), 0.055) << name;
      loudest = std::max(loudest, slot[4]);
    }
    EXPECT_GE(loudest, 0.9) << name;
  }
  const auto point = slots_of("point --duration 50ms --dwell 0.25ms");
  for (std::size_t s = 0; s < point.size(); ++s) {
    const double turn = 200 * 0.25e-3 * static_cast<double>(s);
    EXPECT_NEAR(point[s][4], 0.5 + 0.5 * std::cos(2 * std::numbers::pi * turn), 1e-9);
  }
  const auto lateral = slots_of("lateral --duration 1s");
  double widest = 0;
  for (std::size_t s = 1; s < lateral.size(); ++s)
    widest = std::max(widest, std::abs(lateral[s][1] - lateral[s - 1][1]));
  EXPECT_NEAR(widest, 0.2e-3, 1e-9);
}

TEST(Play, ItsRecordHasTheDrivesOfTheSlotsAndEndsInSilence) {
  const auto file = folder() / "circle.bin";
  const Result result =
      succeeded(play("circle --duration 20ms --layout openmpd --link record:" + file.string() + " --json -"));
  const DriveRecording recording = read_to_silence(file);
  EXPECT_EQ(recording.slot_s, 0.875e-3);
  ASSERT_EQ(recording.drives.size(), 24U);  // 23 slots and a silence
  for (std::size_t s = 0; s + 1 < recording.drives.size(); ++s) {
    const double w = 2 * std::numbers::pi * 70 * 0.875e-3 * static_cast<double>(s);
    EXPECT_EQ(recording.drives[s].slot, s);
    EXPECT_EQ(loudest(recording.drives[s].drive), 1);
    EXPECT_LT(phases_off(recording.drives[s].drive, Transform(1.0), {10e-3 * std::cos(w), 10e-3 * std::sin(w), 0.2}),
              5e-3);
  }
  const json report = json::parse(result.out);
  EXPECT_EQ(report["slots"], 23);
  EXPECT_EQ(report["slot_s"], 0.875e-3);
  EXPECT_EQ(report["parameters"], json({{"radius", 10.0}}));
  EXPECT_EQ(report["drives"], json({{"sent", 23}, {"silent", 0}, {"skipped_slots", 0}, {"lost", 0}}));
  const std::string first = read_text(file);
  ASSERT_EQ(play("circle --duration 20ms --layout openmpd --link record:" + file.string()).exit_code, 0);
  EXPECT_EQ(read_text(file), first);
}

TEST(Play, ACeilingAndARampHoldInItsRecord) {
  const auto file = folder() / "faint.bin";
  succeeded(play("circle --duration 20ms --layout openmpd --ceiling 0.5 --ramp 3.5ms --link record:" + file.string()));
  const DriveRecording recording = read_to_silence(file);
  for (std::size_t s = 0; s < 23; ++s)
    EXPECT_NEAR(loudest(recording.drives[s].drive), 0.5 * std::min(1.0, 0.25 * static_cast<double>(s + 1)), 1e-6) << s;
  for (std::size_t s = 23; s < 27; ++s)
    EXPECT_NEAR(loudest(recording.drives[s].drive), 0.125 * static_cast<double>(26 - s), 1e-6) << s;
}

std::string pattern_file(const std::string& name, const PatternText& text) {
  const auto file = folder() / (name + ".adaptics");
  write_text(file, text.text());
  return file.string();
}
PatternText stopping(double at_ms) {
  return {.keyframes = key("standard", 0, coords(0, 0, 0) + intensity(f64(1))) + "," + key("stop", at_ms)};
}
PatternText turning(double hz) {
  return {.keyframes = key(
              "standard", 0,
              coords(0, 0, 0) + intensity(f64(1)) +
                  brush("circle", fmt::format(R"("radius":{},"am_freq":{},"stm_freq":{})", f64(5), f64(0), f64(hz))))};
}

TEST(Play, AStopEndsIt) {
  const std::string file = pattern_file("stop", stopping(30));
  EXPECT_EQ(slots_of(file).size(), 20U);  // of 1.5 ms
  EXPECT_EQ(slots_of(file + " --duration 15ms").size(), 10U);
  const Result live = succeeded(play(file + " --layout openmpd --json - --dwell 1ms"));
  EXPECT_GT(json::parse(live.out)["drives"]["sent"].get<int>(), 0);
  const Result endless = play("circle --csv -");
  EXPECT_EQ(endless.exit_code, 2);
  EXPECT_CONTAINS(endless.err,
                  "circle plays for more than 500000 slots of 0.875 ms: give a --duration of at most 437.5s");
  const std::string long_one = pattern_file("long", stopping(500'000 * 0.05));
  EXPECT_EQ(play(long_one + " --dwell 0.05ms --csv /dev/null").exit_code, 0);
  EXPECT_EQ(play(pattern_file("longer", stopping(500'001 * 0.05)) + " --dwell 0.05ms --csv /dev/null").exit_code, 2);
  const Result slow = play("lateral --dwell 50ms --duration 1000.05s --csv /dev/null");
  EXPECT_EQ(slow.exit_code, 2);
  EXPECT_CONTAINS(slow.err, "lateral plays for more than 20000 slots of 50 ms: give a --duration of at most 1000s");
}

TEST(Play, RefusesMoreThan500Hz) {
  EXPECT_EQ(play(pattern_file("fast", turning(500)) + " --duration 5ms --csv -").exit_code, 0);
  const Result faster = play(pattern_file("faster", turning(500.5)) + " --duration 5ms --csv -");
  EXPECT_EQ(faster.exit_code, 4);
  EXPECT_CONTAINS(faster.err, "has a brush or a modulation of 500.5 Hz; palpa plays at most 500 Hz");
  const std::string at_100 = pattern_file("coarse", turning(100));
  const Result coarse = play(at_100 + " --duration 50ms --dwell 5ms --csv /dev/null");
  EXPECT_EQ(coarse.exit_code, 0);
  EXPECT_CONTAINS(coarse.err, "--dwell 5 ms: one turn of 100 Hz has 2 places; give at most 0.625 ms");
  const Result another = play(at_100 + " --duration 50ms --dwell 5.1ms --csv /dev/null");
  EXPECT_EQ(another.exit_code, 2);
  EXPECT_CONTAINS(another.err, "places of 5.1 ms cannot follow it: give a --dwell of at most 0.625 ms");
  const Result slow = play(at_100 + " --link sonicsurface:/dev/null");
  EXPECT_EQ(slow.exit_code, 2);
  EXPECT_CONTAINS(slow.err, "takes so long for each, so a sensation has at most 41.7 Hz there");
  const Result other = play("circle --duration 5ms --layout openmpd --frequency 45kHz --link record:/dev/null");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_CONTAINS(other.err, "--frequency: the boards of openmpd emit 40 kHz only");
}

TEST(Play, SaysWhatIsWrong) {
  const auto says = [](const std::string& line, int code, const std::string& told) {
    const Result result = play(line);
    EXPECT_EQ(result.exit_code, code) << line;
    EXPECT_CONTAINS(result.err, told);
  };
  says("", 2, "give one sensation: a pattern's file, or circle, heartbeat, lateral, point, sweep");
  says("circle point", 2, "give one sensation");
  says("nobody", 4, "nobody: neither a file nor a known sensation; known: circle, heartbeat, lateral, point, sweep");
  says("circle --param radius", 2, "--param: 'radius' is not NAME=VALUE with a finite number, such as rate=80");
  says("circle --param radius=nan", 2, "--param: 'radius=nan' is not NAME=VALUE");
  says("circle --param width=3", 2, "circle.adaptics has no parameter 'width'; it has radius");
  says("circle --duration 5ms --csv /dev/null --param radius=31", 0,
       "--param: radius is 1 to 30, so it is 30 and not 31");
  says("circle --at 0,0,101m", 2, "--at is farther than 100 m from the array");
  says("circle --duration 1ms --layout openmpd --link record:/dev/null --at 0,0,-10cm", 0, "lies behind the array");
  says("circle --duration 1ms --layout openmpd --link record:/dev/null --at 0,0,3m", 0, "the sensation");
  says("circle --duration 5ms --layout openmpd --csv /dev/null --at 0,0,-10cm", 0,
       "the sensation lies behind the array");
  says("circle --on palm --source synthetic", 2, "--on goes with a tracker of hands");
  says("circle --on finger --source synthetic", 2, "--on finger needs --scene");
}

TEST(Play, APlaceThatCannotBeDrivenIsSilentInItsTable) {
  const std::string far = pattern_file("far", {.keyframes = key("standard", 0, coords(2e5, 0, 0) + intensity(f64(1)))});
  const auto slots = slots_of(far + " --duration 5ms");
  EXPECT_FALSE(slots.empty());
  for (const auto& slot : slots)
    EXPECT_EQ(slot[4], 0);
  EXPECT_CONTAINS(play(far + " --duration 5ms --csv /dev/null").err, "farther than 100 m from the array");
}

TEST(Play, SeveralParametersAndTheLastOfEachCount) {
  const json report = json::parse(
      play("sweep --param speed=2 --param loop=0 --param speed=3 --duration 5ms --csv /dev/null --json -").out);
  EXPECT_EQ(report["parameters"], json({{"loop", 0.0}, {"speed", 3.0}}));
}

TEST(Play, DrawsAPicture) {
  const auto file = folder() / "heartbeat.png";
  const Result result = succeeded(play("heartbeat --duration 1s --png " + file.string()));
  EXPECT_EQ(result.out, "heartbeat: 1600 slots of 0.625 ms, 1 s\n");
  EXPECT_TRUE(read_text(file).starts_with("\x89PNG"));
}

}  // namespace
}  // namespace palpa::test
