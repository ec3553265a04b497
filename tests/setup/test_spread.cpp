// --spread: its texts, its percentiles, and what it makes of drives and fields, against formulas and against the same
// numbers by another way.
#include "setup/options/spread.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "sensing/rig.hpp"
#include "setup/tasks/drive.hpp"
#include "setup/tasks/field.hpp"
#include "support/device.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using array::Spread;
using setup::Draws;
using setup::Percentiles;

TEST(Spread, ReadsTexts) {
  EXPECT_EQ(setup::parse_spread("amplitude=10%,phase=0.2,position=0.5mm,temperature=2"),
            (Spread{.amplitude = 0.1, .phase_rad = 0.2, .position_m = 5e-4, .temperature = 2}));
  EXPECT_EQ(setup::parse_spread("position=0.0005,amplitude=0.1"), (Spread{.amplitude = 0.1, .position_m = 5e-4}));
  EXPECT_EQ(setup::parse_spread("phase=0"), Spread());
  EXPECT_EQ(setup::parse_spread("amplitude=100%,phase=3.141592653589793,position=10mm,temperature=20"),
            (Spread{.amplitude = 1, .phase_rad = std::numbers::pi, .position_m = 0.01, .temperature = 20}));
}

TEST(Spread, RefusesOtherTexts) {
  const auto refused = [](const std::string& text, const char* expected) {
    EXPECT_ERROR(setup::parse_spread(text), Exit::usage, expected);
  };
  refused("loudness=1", "'loudness=1' is not one of amplitude=, phase=, position= and temperature=");
  refused("amplitude", "'amplitude' is not one of");
  refused("", "'' is not one of");
  refused("phase=0.1,", "'' is not one of");
  refused("phase=0.1,phase=0.1", "phase is given twice");
  for (const char* bad : {"amplitude=-1%", "amplitude=101%", "amplitude=100.00000000000003%", "amplitude=10mm",
                          "amplitude=", "amplitude=%", "amplitude=nan"})
    refused(bad, "is not a part such as 0.1 or 10%, from 0 to 100%");
  for (const char* bad : {"phase=-0.1", "phase=4", "phase=3.1415926535897936", "phase=10%", "phase=inf"})
    refused(bad, "is not an angle in radians");
  for (const char* bad :
       {"position=-1mm", "position=11mm", "position=10.000000000000003mm", "position=5%", "position=1s"})
    refused(bad, "is not a length");
  for (const char* bad : {"temperature=-1", "temperature=21", "temperature=20.000000000000004", "temperature=2K"})
    refused(bad, "is not kelvins");
}

/// A rig with one camera for each residual; a negative one is left out.
std::string rig_with(const std::string& name, const std::vector<double>& residuals) {
  sensing::Rig rig;
  for (const double residual : residuals) {
    sensing::Camera& camera = rig.cameras.emplace_back();
    camera.name = "camera " + std::to_string(rig.cameras.size());
    camera.width = camera.height = 4;
    camera.fx = camera.fy = 4;
    if (residual >= 0) camera.residual_m = residual;
  }
  const std::filesystem::path file = scratch_folder("spread") / name;
  write_text(file, sensing::to_toml(rig));
  return file;
}

TEST(Spread, APositionMayBeWhatACalibrationLeft) {
  const std::string rig = rig_with("rig.toml", {3e-4, -1, 4e-4});
  const Spread spread = setup::parse_spread("phase=0.1,position=" + rig);
  EXPECT_DOUBLE_EQ(spread.position_m, std::sqrt((9e-8 + 16e-8) / 2));
  EXPECT_EQ(spread.phase_rad, 0.1);
  EXPECT_EQ(setup::parse_spread("position=" + rig_with("exact.toml", {0})).position_m, 0);
}

TEST(Spread, RefusesARigThatGivesNoPosition) {
  EXPECT_REFUSED(setup::parse_spread("position=" + rig_with("by-hand.toml", {-1, -1})),
                 "by-hand.toml: no [[camera]] has a residual_m");
  EXPECT_REFUSED(setup::parse_spread("position=" + rig_with("far.toml", {0.02})),
                 "far.toml: residual_m is 0.02 m; --spread position= takes at most 10mm");
  EXPECT_REFUSED(setup::parse_spread("position=nowhere/none.toml"), "nowhere/none.toml");
  // The option's text alone is right. Its file is read later, like those of other options.
  setup::check_spread("position=nowhere/none.toml");
  EXPECT_ERROR(setup::check_spread("position=none.txt"), Exit::usage, "'position=none.txt' is not a length");
  EXPECT_ERROR(setup::check_spread("phase=none.toml"), Exit::usage, "is not an angle in radians");
}

TEST(Spread, PercentilesAreInterpolated) {
  std::vector<double> values;
  for (int i = 100; i >= 0; --i)
    values.push_back(i);
  Percentiles p = setup::percentiles(values);
  EXPECT_DOUBLE_EQ(p.p05, 5);
  EXPECT_DOUBLE_EQ(p.p50, 50);
  EXPECT_DOUBLE_EQ(p.p95, 95);
  p = setup::percentiles({3, 1});
  EXPECT_DOUBLE_EQ(p.p05, 1.1);
  EXPECT_DOUBLE_EQ(p.p50, 2);
  EXPECT_DOUBLE_EQ(p.p95, 2.9);
  p = setup::percentiles({7});
  EXPECT_EQ(p.p05, 7);
  EXPECT_EQ(p.p95, 7);
}

struct Sounding {
  array::Layout layout;
  setup::DriveResult drive;

  explicit Sounding(const std::string& name, const std::vector<setup::AskedFocus>& foci)
      : layout(array::load_layout(name)), drive(setup::make_drive(layout, foci, {})) {}
  setup::DriveSpread with(const Spread& spread, const Draws& draws = {400, 1}) const {
    return setup::spread_of_drive(layout, drive.drive, drive.foci, {}, array::Directivity::t4010a1, spread, draws);
  }
};

/// A focus adds N sounds in phase. Independent phases of deviation s leave e^{-s^2/2} of it on average, independent
/// amplitudes leave all of it and scatter it by s sqrt(sum a^2) / sum a.
TEST(Spread, OfOneFocusFollowsTheFormulas) {
  const Sounding board("openmpd", {{{0, 0, 0.15}, 1}});
  const double designed = board.drive.pressure.pascals[0];
  for (const double s : {0.1, 0.3, 0.6}) {
    const Percentiles p = board.with({.phase_rad = s}).pressures_pa[0];
    EXPECT_NEAR(p.p50 / designed, std::exp(-s * s / 2), 0.01) << s;
    EXPECT_LT(p.p95, designed);
  }
  double sum = 0, squares = 0;
  for (std::size_t t = 0; t < board.layout.transducers.size(); ++t) {
    array::Drive alone(board.layout.transducers.size(), {0, 0});
    alone[t] = board.drive.drive[t];
    const double part = std::abs(acoustics::pressure_at(board.layout, alone, {0, 0, 0.15}));
    sum += part;
    squares += part * part;
  }
  for (const double s : {0.05, 0.2}) {
    const Percentiles p = board.with({.amplitude = s}, {2000, 1}).pressures_pa[0];
    EXPECT_NEAR(p.p50 / designed, 1, 0.01) << s;
    EXPECT_NEAR((p.p95 - p.p05) / designed, 2 * 1.645 * s * std::sqrt(squares) / sum,
                0.1 * s * std::sqrt(squares) / sum);
  }
}

/// Whatever is warmer or colder alone moves nothing sideways: the pressures are those of the same drive in that air.
TEST(Spread, OfTheTemperatureIsTheDriveInOtherAir) {
  const Sounding board("autd3", {{{0, 0, 0.2}, 1}, {{0.03, 0, 0.2}, 0.7F}});
  const Draws draws{300, 4};
  const setup::DriveSpread spread = board.with({.temperature = 6}, draws);
  std::vector<double> pascals;
  for (std::uint32_t draw = 0; draw < draws.count; ++draw) {
    const double warmer = array::as_built(board.layout, board.drive.drive, {.temperature = 6}, 4, draw).temperature;
    const array::Medium air{.sound_speed = array::sound_speed_at(20 + warmer)};
    pascals.push_back(acoustics::pressure_at_foci(board.layout, board.drive.drive, board.drive.foci, air).pascals[1]);
  }
  const Percentiles expected = setup::percentiles(pascals);
  EXPECT_DOUBLE_EQ(spread.pressures_pa[1].p05, expected.p05);
  EXPECT_DOUBLE_EQ(spread.pressures_pa[1].p50, expected.p50);
  EXPECT_DOUBLE_EQ(spread.pressures_pa[1].p95, expected.p95);
  EXPECT_LT(spread.evenness.p05, spread.evenness.p95);
}

setup::FieldTask field_task() {
  setup::FieldTask task;
  task.layout = "openmpd";
  task.foci = {"0,0,150mm"};
  task.place.line = {"-10mm,0,150mm", "10mm,0,150mm"};
  task.place.samples = 21;
  task.spread.text = "amplitude=10%,phase=0.3,position=0.5mm,temperature=2";
  task.spread.draws = 100;
  return task;
}

/// At the focus, the field and the drive are two ways to the same numbers.
TEST(Spread, OfAFieldIsThatOfTheDrive) {
  setup::FieldTask task = field_task();
  task.air.not_normally = true;  // a drive's pressures are without absorption
  setup::CommonOptions common;
  common.backend = setup::Backend::cpu;
  common.seed = 6;
  const setup::FieldResult field = setup::sum_field(task, common);
  const Sounding board("openmpd", {{{0, 0, 0.15}, 1}});
  const Percentiles focus = board.with(setup::parse_spread(task.spread.text), {100, 6}).pressures_pa[0];
  ASSERT_EQ(field.spread->amplitudes.size(), 21u);
  const Percentiles& middle = field.spread->amplitudes[10];
  EXPECT_NEAR(middle.p05, focus.p05, 1e-4 * focus.p50);
  EXPECT_NEAR(middle.p50, focus.p50, 1e-4 * focus.p50);
  EXPECT_NEAR(middle.p95, focus.p95, 1e-4 * focus.p50);
  // The loudest point of a draw is at least as loud as the focus.
  EXPECT_GE(field.spread->peak_pa.p05, middle.p05);
  EXPECT_LE(std::abs(field.spread->peak_m[0].p50), 1e-3);
}

TEST(Spread, OfAFieldIsTheSameOnBothBackends) {
  const setup::FieldTask task = field_task();
  setup::CommonOptions host, device;
  host.backend = setup::Backend::cpu;
  const setup::FieldResult a = setup::sum_field(task, host), b = setup::sum_field(task, device);
  for (std::size_t i = 0; i < a.spread->amplitudes.size(); ++i) {
    EXPECT_NEAR(a.spread->amplitudes[i].p05, b.spread->amplitudes[i].p05, 1e-4 * a.peak_pa());
    EXPECT_NEAR(a.spread->amplitudes[i].p95, b.spread->amplitudes[i].p95, 1e-4 * a.peak_pa());
  }
}

TEST(Spread, IsWrittenAsTriples) {
  const nlohmann::json json = nlohmann::json::parse(setup::to_json(setup::sum_field(field_task(), {})));
  const nlohmann::json& spread = json["spread"];
  EXPECT_EQ(spread["draws"], 100);
  EXPECT_EQ(spread["seed"], 0);
  ASSERT_EQ(spread["peak_pa"].size(), 3u);
  EXPECT_LT(spread["peak_pa"][0], spread["peak_pa"][1]);
  EXPECT_LT(spread["peak_pa"][1], spread["peak_pa"][2]);
  ASSERT_EQ(spread["peak_m"].size(), 3u);
  EXPECT_EQ(spread["peak_m"][2].size(), 3u);
}

TEST(Spread, SaysWhatDoesNotGoTogether) {
  setup::SpreadOptions options;
  setup::MediumOptions medium;
  options.text = "temperature=1";
  check(options, medium);
  medium.sound_speed = 340;
  EXPECT_ERROR(check(options, medium), Exit::usage, "--sound-speed replaces the temperature");
  options.text = "phase=0.1";
  check(options, medium);
}

}  // namespace
}  // namespace palpa::test
