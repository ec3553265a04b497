// OpenMPD boards as a guard plays to them, with emulators on a bus in memory: what they sound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "driver/openmpd/openmpd_files.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
constexpr double pi = std::numbers::pi;
constexpr double wave_number = 2 * pi * 40e3 / 343.21;

/// Computed here, omnidirectional.
std::complex<double> pressure_at(const array::Layout& layout, const array::Drive& drive, const Vec3& place) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const Vec3 d = place - layout.transducers[i].position;
    const double r = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    sum +=
        std::polar(static_cast<double>(drive[i].amplitude) / r, static_cast<double>(drive[i].phase) + wave_number * r);
  }
  return sum;
}

/// Climbs from `from` to the nearest peak, to a micrometre.
Vec3 peak_near(const array::Layout& layout, const array::Drive& drive, Vec3 at) {
  for (double step = 1e-3; step > 1e-6;) {
    Vec3 best = at;
    double most = std::abs(pressure_at(layout, drive, at));
    for (const Vec3& d : {Vec3{step, 0, 0}, Vec3{-step, 0, 0}, Vec3{0, step, 0}, Vec3{0, -step, 0}, Vec3{0, 0, step},
                          Vec3{0, 0, -step}}) {
      const double here = std::abs(pressure_at(layout, drive, at + d));
      if (here > most) {
        most = here;
        best = at + d;
      }
    }
    if (best == at) step /= 2;
    at = best;
  }
  return at;
}

/// The drive after the board's quantisation, as documented.
array::Drive quantised(const array::Drive& drive) {
  array::Drive out(drive.size());
  for (std::size_t i = 0; i < drive.size(); ++i) {
    const int width = static_cast<int>(std::trunc(64 * (2 / pi) * std::asin(static_cast<double>(drive[i].amplitude))));
    const double turns = static_cast<double>(drive[i].phase) / (2 * pi);
    const double step = std::floor(128 * (turns - std::floor(turns)) + (64 - width) / 2.0 + 0.5);
    // A pulse whose first count is `step`: its middle is (64 - width) / 2 before that of a full pulse.
    out[i] = {static_cast<float>(std::sin(width * pi / 128)),
              static_cast<float>(2 * pi * (step - (64 - width) / 2.0) / 128)};
  }
  return out;
}

TEST(OpenMpdBoard, ComesUpSilentAndInStepWithItsDividerSet) {
  OpenMpdRig rig;
  const double begin_s = rig.clock.now_s();
  rig.open();
  EXPECT_LT(rig.clock.now_s() - begin_s, 1.2);
  rig.look();
  EXPECT_FALSE(rig.sounds());
  EXPECT_EQ(rig.emulators[0]->fpga().divider(), 4u);
  EXPECT_EQ(rig.emulators[0]->fpga().dividers_set(), 1u);
  EXPECT_EQ(rig.faults[0]->bulk_bytes, 5u * 512);
  EXPECT_EQ(rig.violations(), "");
  EXPECT_TRUE(rig.notes.warnings.empty());
}

TEST(OpenMpdBoard, SoundsAsTheDriveAsks) {
  for (const bool calibrated : {false, true}) {
    OpenMpdRig rig;
    openmpd::Calibration calibration;
    if (calibrated) {
      calibration = made_up_calibration(5);
      calibration.factors = openmpd::Calibration{}.factors;
      const auto folder = scratch_folder("openmpd-calibrated");
      write_text(folder / "board_1.pat", board_file_text("EMU1", calibration));
      rig.files = folder.string();
    }
    rig.open();
    for (const Vec3& focus : {Vec3{0, 0, 0.15}, Vec3{0.03, -0.02, 0.12}}) {
      const array::Drive drive = focus_drive(rig.layout, focus);
      rig.play(drive, 0.02);
      const array::Drive heard = openmpd::heard_drive(rig.emulators[0]->fpga().pulses(), calibration);
      const Vec3 peak = peak_near(rig.layout, drive, focus), heard_peak = peak_near(rig.layout, heard, focus);
      EXPECT_LT(std::sqrt(glm::dot(peak - heard_peak, peak - heard_peak)), 0.3e-3);
      const double there = std::abs(pressure_at(rig.layout, heard, focus));
      if (!calibrated) {
        EXPECT_NEAR(there / std::abs(pressure_at(rig.layout, quantised(drive), focus)), 1, 0.002);
      }
      const array::Drive even = focus_drive(rig.layout, focus, array::Weighting::uniform);
      rig.play(even, 0.02);
      const array::Drive heard_even = openmpd::heard_drive(rig.emulators[0]->fpga().pulses(), calibration);
      EXPECT_NEAR(std::abs(pressure_at(rig.layout, heard_even, focus)) / std::abs(pressure_at(rig.layout, even, focus)),
                  1, 0.01);
    }
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(OpenMpdBoard, SilenceSoundsWithinFiveMillisecondsAndBuffersStayEmpty) {
  OpenMpdRig rig;
  rig.open();
  rig.play(focus_drive(rig.layout), 0.1);
  EXPECT_TRUE(rig.sounds());
  rig.board->all_off();
  rig.clock.sleep_s(0.2e-3);
  rig.look();
  EXPECT_FALSE(rig.sounds());
  rig.play(focus_drive(rig.layout), 0.1);
  rig.board->play(rig.slot++, array::Drive(256, {0, 0}));
  rig.clock.sleep_s(0.2e-3);
  rig.look();
  EXPECT_FALSE(rig.sounds());
  EXPECT_TRUE(rig.board->close());
  rig.board.reset();
  rig.clock.sleep_s(1);
  rig.look();
  EXPECT_EQ(rig.violations(), "");
  // The burst at the opening is three frames; afterwards, there is one at a time.
  EXPECT_LE(rig.emulators[0]->fpga().most_buffered(), 1536u);
}

/// The number of sounding frames that each board has shown.
std::vector<std::uint64_t> count_sounding(OpenMpdRig& rig, std::vector<std::uint64_t>& shown) {
  shown.assign(rig.emulators.size(), 0);
  for (std::size_t i = 0; i < rig.emulators.size(); ++i) {
    rig.emulators[i]->fpga().on_shown([&shown, i](double, const openmpd::Pulses& pulses) {
      shown[i] += std::any_of(pulses.begin(), pulses.end(), [](const auto& pulse) { return pulse.width > 0; }) ? 1 : 0;
    });
  }
  return shown;
}

TEST(OpenMpdBoard, CountsTheDrivesThatItsBoardsAreShown) {
  OpenMpdRig rig({"EMU1", "EMU2"});
  rig.open();
  std::vector<std::uint64_t> shown;
  count_sounding(rig, shown);
  const array::Drive drive = focus_drive(rig.layout), silent(rig.layout.transducers.size(), {0, 0});
  const array::Drive faint(rig.layout.transducers.size(), {1e-4f, 0});
  const auto counts = [&] { return rig.board->counts(); };
  rig.play(drive, 0.15);
  rig.play(silent, 0.03);
  EXPECT_EQ(counts().submitted.drives, 100u);
  EXPECT_EQ(counts().completed.drives, 100u);
  EXPECT_EQ(shown, (std::vector<std::uint64_t>{100, 100}));
  rig.play(faint, 0.015);
  EXPECT_EQ(counts().completed.drives, 110u) << "too faint for a first step: silence is what it asks for";
  // One board takes nothing for a while: drives are replaced, and both boards miss the same ones.
  rig.faults[1]->takes_nothing = true;
  rig.play(drive, 0.15);
  EXPECT_LT(counts().completed.drives, 120u);
  const std::uint64_t before = counts().completed.drives;
  rig.play(faint, 0.015);
  EXPECT_EQ(counts().completed.drives, before) << "the board does not take the silence either";
  rig.faults[1]->takes_nothing = false;
  rig.play(silent, 0.03);
  EXPECT_LT(counts().completed.drives, 120u);
  EXPECT_EQ(counts().completed.drives, shown[0] + 10);
  EXPECT_EQ(counts().completed.drives, shown[1] + 10);
  EXPECT_EQ(counts().submitted.drives, counts().completed.drives);
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdBoard, ADriveOfSeveralStepsIsOne) {
  OpenMpdRig rig;
  rig.ramp_s = 20e-3;
  rig.open();
  rig.play(focus_drive(rig.layout), 0.15);
  EXPECT_EQ(rig.board->counts().submitted.drives, 100u);
  EXPECT_EQ(rig.board->counts().completed.drives, 100u);
}

TEST(OpenMpdBoard, WhatABoardDidNotTakeToTheLastByteIsNotCompleted) {
  OpenMpdRig rig;
  rig.open();
  const array::Drive drive = focus_drive(rig.layout);
  rig.play(drive, 0.015);
  rig.faults[0]->unplug_after = 100;
  rig.play(drive, 0.15);
  EXPECT_EQ(rig.board->counts().completed.drives, 10u);
  EXPECT_EQ(rig.board->counts().submitted.drives, 11u);
  *rig.faults[0] = {};
  rig.play(drive, 3);
  EXPECT_GT(rig.board->counts().completed.drives, 100u) << "it plays on";
  EXPECT_EQ(rig.board->counts().submitted.drives, rig.board->counts().completed.drives + 1) << "the one that was cut";
}

TEST(OpenMpdBoard, AtItsEndNothingWaitsThatWouldSound) {
  for (const double ramp_s : {0.0, 20e-3}) {
    OpenMpdRig rig({"EMU1", "EMU2"});
    rig.ramp_s = ramp_s;
    rig.open();
    rig.play(focus_drive(rig.layout), 0.02);
    EXPECT_TRUE(rig.sounds());
    rig.board->all_off();
    EXPECT_TRUE(rig.board->close());
    rig.clock.sleep_s(0.01);
    rig.look();
    for (const auto& emulator : rig.emulators) {
      EXPECT_FALSE(emulator->fpga().sounds());
      EXPECT_FALSE(emulator->fpga().sounds_behind());
    }
  }
}

TEST(OpenMpdBoard, ARampGoesFromFocusToFocusInSmallSteps) {
  OpenMpdRig rig({"EMU1", "EMU2"}), plain({"EMU1", "EMU2"});
  rig.ramp_s = 20e-3;
  rig.open();
  plain.open();
  const auto drive_to = [&](double x) {
    const array::SlotFocus foci[]{{{x, 0, 0.12}}};
    array::DriveOptions options;
    options.weighting = array::Weighting::uniform;
    return array::drive_for(rig.layout, foci, options);
  };
  rig.play(drive_to(0), 0.03);
  std::vector<openmpd::Pulses> shown{rig.emulators[0]->fpga().pulses()};
  rig.emulators[0]->fpga().on_shown([&](double, const openmpd::Pulses& pulses) { shown.push_back(pulses); });
  for (const double x : {2e-3, 4e-3, 0.0}) {
    rig.play(drive_to(x), rig.slot_s);
    plain.play(drive_to(x), plain.slot_s);
    EXPECT_EQ(rig.emulators[0]->fpga().pulses(), plain.emulators[0]->fpga().pulses()) << "where it goes to";
    EXPECT_EQ(rig.emulators[1]->fpga().pulses(), plain.emulators[1]->fpga().pulses());
  }
  ASSERT_EQ(shown.size(), 1u + 3 * 7) << "half a slot of 1.5 ms has seven frames of 0.1 ms";
  int most = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) {
    for (std::size_t pin = 0; pin < 256; ++pin) {
      const int apart = (shown[i][pin].phase - shown[i - 1][pin].phase) & 127;
      most = std::max(most, std::min(apart, 128 - apart));
      EXPECT_EQ(shown[i][pin].width, 64) << "at full amplitude all the way";
    }
  }
  EXPECT_GT(most, 3);
  EXPECT_LE(most, 64 / 7 + 2) << "of 128 steps, and the rounding";
  rig.board->all_off();
  rig.clock.sleep_s(1e-3);
  rig.look();
  EXPECT_FALSE(rig.sounds());
  EXPECT_EQ(rig.emulators[0]->fpga().frames(), rig.emulators[1]->fpga().frames());
  EXPECT_EQ(rig.violations(), "");
  // If slots are too short for two frames, a drive is one frame.
  OpenMpdRig fast;
  fast.ramp_s = 20e-3;
  fast.slot_s = 250e-6;
  fast.open();
  const std::uint64_t before = fast.emulators[0]->fpga().frames();
  fast.play(focus_drive(fast.layout), 10 * fast.slot_s);
  EXPECT_EQ(fast.emulators[0]->fpga().frames(), before + 10);
}

TEST(OpenMpdBoard, TwoBoardsGetTheirHalvesAndEqualFrames) {
  OpenMpdRig rig({"EMU1", "EMU2"});
  rig.open();
  array::Drive drive(512);
  for (std::size_t i = 0; i < drive.size(); ++i)
    drive[i] = {i < 256 ? 0.5f : 1.0f, 0};
  rig.play(drive, 2);
  EXPECT_EQ(rig.emulators[0]->fpga().frames(), rig.emulators[1]->fpga().frames());
  EXPECT_EQ(rig.emulators[0]->fpga().pulses()[3].width, openmpd::width_of(0.5f));
  EXPECT_EQ(rig.emulators[1]->fpga().pulses()[3].width, 64);
  EXPECT_EQ(rig.emulators[0]->fpga().shown_s(), rig.emulators[1]->fpga().shown_s());
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdBoard, KeepsABoardThatGetsNothingFromCuttingTheNextFrame) {
  OpenMpdRig rig;
  rig.open();
  const std::uint64_t before = rig.emulators[0]->fpga().frames();
  for (int i = 0; i < 800; ++i) {
    rig.clock.sleep_s(5e-3);
    rig.board->tend();
  }
  rig.look();
  EXPECT_GE(rig.emulators[0]->fpga().frames(), before + 7);
  EXPECT_FALSE(rig.sounds());
  // Not while something sounds: then the loop provides the drives, and the guard handles the loop's end.
  rig.play(focus_drive(rig.layout), 0.1);
  const std::uint64_t playing = rig.emulators[0]->fpga().frames();
  for (int i = 0; i < 100; ++i) {
    rig.clock.sleep_s(5e-3);
    rig.board->tend();
  }
  rig.look();
  EXPECT_EQ(rig.emulators[0]->fpga().frames(), playing);
}

TEST(OpenMpdBoard, RefusesWhatCannotBePlayed) {
  const auto refusal = [](auto&& change, Exit code) {
    OpenMpdRig rig;
    change(rig);
    return error_of([&] { rig.open(); }, code);
  };
  const auto has = [](const std::string& line, const std::string& part) {
    EXPECT_NE(line.find(part), std::string::npos) << line;
  };
  has(refusal([](auto& rig) { rig.argument = "NONE"; }, Exit::failed),
      "no OpenMPD board has the serial number NONE: these are plugged in: EMU1");
  has(refusal([](auto& rig) { rig.argument = ""; }, Exit::usage), "SERIAL");
  has(refusal([](auto& rig) { rig.argument = "A,,B"; }, Exit::usage), "SERIAL");
  has(refusal([](auto& rig) { rig.argument = "EMU1,EMU1"; }, Exit::usage), "twice");
  has(refusal([](auto& rig) { rig.argument = "EMU1,EMU2"; }, Exit::usage),
      "has 1 OpenMPD boards, but 2 serial numbers");
  has(refusal([](auto& rig) { rig.layout = array::load_layout("sonicsurface"); }, Exit::usage), "--layout openmpd");
  has(refusal([](auto& rig) { rig.slot_s = 40e-6; }, Exit::usage), "0.05 ms");
  has(refusal([](auto& rig) { rig.slot_s = 60e-6; }, Exit::usage), "8.5 MB/s");
  EXPECT_EQ(openmpd::divider_for(1.5e-3), 4);
  EXPECT_EQ(openmpd::divider_for(250e-6), 4);
  EXPECT_EQ(openmpd::divider_for(100e-6), 2);
  EXPECT_EQ(openmpd::divider_for(50e-6), 1);
  // Sixteen boards at 10 kHz exceed a bus. At 4 kHz they do not, nor on two buses.
  for (const auto& [slot_s, buses, fits] : {std::tuple{100e-6, 1u, false}, {250e-6, 1u, true}, {200e-6, 2u, true}}) {
    std::vector<std::unique_ptr<openmpd::EmulatedBoard>> more;
    OpenMpdRig rig;
    rig.layout.boards.clear();
    rig.layout.transducers.resize(16 * 256);
    rig.argument.clear();
    for (unsigned i = 0; i < 16; ++i) {
      more.push_back(std::make_unique<openmpd::EmulatedBoard>("B" + std::to_string(i)));
      rig.bus.plug(*more.back(), 1 + i % buses);
      rig.layout.boards.push_back({"openmpd", 256 * i, 256, 0.168, 0.168});
      rig.argument += (i == 0 ? "B" : ",B") + std::to_string(i);
    }
    rig.slot_s = slot_s;
    const std::string line = error_of([&] { rig.open(); }, Exit::usage);
    EXPECT_EQ(line.empty(), fits) << line;
    if (!fits) has(line, "16 boards on bus 1 need 81.9 MB/s");
  }
}

}  // namespace
}  // namespace palpa::test
