// OpenMPD boards as a guard plays to them, with emulators on a bus in memory: what they sound.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "driver/openmpd/openmpd_files.hpp"
#include "driver/openmpd/openmpd_rig.hpp"
#include "support/boards.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
constexpr float pi = std::numbers::pi_v<float>;
TEST(OpenMpdBoard, ComesUpSilentAndInStepWithItsDividerSet) {
  OpenMpdRig rig;
  const double begin_s = rig.clock.now_s();
  rig.open();
  EXPECT_LT(rig.clock.now_s() - begin_s, 1.2);
  rig.look();
  EXPECT_FALSE(rig.sounds());
  EXPECT_EQ(rig.fpga(0).divider(), 4u);
  EXPECT_EQ(rig.fpga(0).dividers_set(), 1u);
  EXPECT_EQ(rig.faults[0]->bulk_bytes, 5u * 512);
  EXPECT_EQ(rig.violations(), "");
  EXPECT_TRUE(rig.notes.warnings.empty());
}

TEST(OpenMpdBoard, EachTransducerSoundsAsTheDriveAsksAndAsItsFileCorrects) {
  for (const bool calibrated : {false, true}) {
    OpenMpdRig rig;
    openmpd::Calibration calibration;
    if (calibrated) {
      calibration = made_up_calibration(5);
      const auto folder = scratch_folder("openmpd-calibrated");
      write_text(folder / "board_1.pat", board_file_text("EMU1", calibration));
      rig.files = folder.string();
    }
    rig.open();
    std::minstd_rand random(1);
    std::uniform_real_distribution<float> amplitudes(0, 1), phases(-pi, pi);
    for (int round = 0; round < 40; ++round) {
      array::Drive drive(256);
      for (auto& [amplitude, phase] : drive) {
        amplitude = amplitudes(random);
        phase = phases(random);
      }
      rig.play(drive, rig.slot_s);
      const array::Drive heard = openmpd::heard_drive(rig.fpga(0).pulses(), calibration);
      for (std::size_t t = 0; t < drive.size(); ++t) {
        const float asked = drive[t].amplitude;  // with its factor
        EXPECT_LE(heard[t].amplitude, asked + 1e-6f) << t;
        EXPECT_GT(heard[t].amplitude, asked - pi / 128 - 1e-6f) << t;
        const float turns = (heard[t].phase - drive[t].phase) / (2 * pi);
        EXPECT_TRUE(heard[t].amplitude == 0 || std::abs(turns - std::round(turns)) <= 1.01f / 256) << t;
      }
    }
    EXPECT_EQ(rig.violations(), "");
  }
}

/// A slave runs 19.04 us after its master. A board's own file contains that.
TEST(OpenMpdBoard, ASlaveWithoutAFileGetsItsPhasesEarlierByItsLag) {
  const auto folder = scratch_folder("openmpd-lag");
  write_text(folder / "board_2.pat", board_file_text("EMU2", {}));
  const struct {
    const char* argument;
    bool file;
    double lag;
    std::size_t told;
  } cases[] = {{"EMU1,EMU2", false, 0.762, 1},
               {"EMU1,EMU2", true, 0, 0},
               {"EMU1,EMU2,lag=0.25", false, 0.25, 0},
               {"EMU1,EMU2,lag=0", false, 0, 0},
               {"EMU1,EMU2,lag=0.25", true, 0.25, 0}};
  for (const auto& [argument, file, lag, told] : cases) {
    OpenMpdRig rig({"EMU1", "EMU2"});
    rig.argument = argument;
    if (file) rig.files = folder.string();
    rig.open();
    rig.play(array::Drive(512, {1.0f, 0.0f}), rig.slot_s);
    for (std::size_t board = 0; board < 2; ++board) {
      const array::Drive heard = openmpd::heard_drive(rig.fpga(board).pulses(), {}, board == 0 ? 0 : lag);
      for (const array::TransducerDrive& one : heard)
        ASSERT_NEAR(std::remainder(one.phase, 2 * pi), 0, pi / 128 + 1e-5) << argument << file << board;
    }
    const auto tells = [](const std::string& line) {
      return line.find("board EMU2 has no file") != line.npos && line.find("than the master EMU1,") != line.npos;
    };
    EXPECT_EQ(static_cast<std::size_t>(std::ranges::count_if(rig.notes.infos, tells)), told) << argument << file;
  }
  for (const char* wrong : {"EMU1,EMU2,lag=1", "EMU1,EMU2,lag=-0.1", "EMU1,EMU2,lag=", "EMU1,lag=x"})
    EXPECT_ERROR(openmpd::parse_boards(wrong), Exit::usage, "a number from 0 to below 1");
  EXPECT_ERROR(openmpd::parse_boards("EMU1,lag=0.25,EMU2"), Exit::usage,
               "a link's lag= comes last, after its boards and other words: EMU1,EMU2,lag=0.25");
  EXPECT_ERROR(openmpd::parse_boards("EMU1,EMU2,lag=0.25,lag=0.5"), Exit::usage, "lag= is given twice");
  for (const char* one : {"EMU1,lag=0.25", "EMU1,lag=0", "EMU1@1-4,lag=0.25"})
    EXPECT_ERROR(openmpd::parse_boards(one), Exit::usage, "but the link has one board: leave it out");
}

TEST(OpenMpdBoard, SilenceSoundsWithinFiveMillisecondsAndBuffersStayEmpty) {
  OpenMpdRig rig;
  rig.open();
  rig.play(focus_drive(rig.layout), 0.1);
  EXPECT_TRUE(rig.sounds());
  rig.board->all_off();
  EXPECT_TRUE(rig.silent_after(0.2e-3));
  rig.play(focus_drive(rig.layout), 0.1);
  rig.board->play(rig.slot++, array::Drive(256, {0, 0}));
  EXPECT_TRUE(rig.silent_after(0.2e-3));
  EXPECT_TRUE(rig.board->close());
  rig.board.reset();
  rig.clock.sleep_s(1);
  rig.look();
  EXPECT_EQ(rig.violations(), "");
  // The burst at the opening is three frames; afterwards, there is one at a time.
  EXPECT_LE(rig.fpga(0).most_buffered(), 1536u);
}

TEST(OpenMpdBoard, CountsTheDrivesThatItsBoardsAreShown) {
  OpenMpdRig rig({"EMU1", "EMU2"});
  rig.open();
  std::vector<std::uint64_t> shown(2);  // frames that sound
  for (std::size_t i = 0; i < 2; ++i) {
    rig.fpga(i).on_shown([&shown, i](double, const openmpd::Pulses& pulses) {
      shown[i] += std::any_of(pulses.begin(), pulses.end(), [](const auto& pulse) { return pulse.width > 0; }) ? 1 : 0;
    });
  }
  const array::Drive drive = focus_drive(rig.layout), silent(rig.layout.transducers.size(), {0, 0});
  const array::Drive faint(rig.layout.transducers.size(), {1e-4f, 0});
  const auto counts = [&] { return rig.board->counts(); };
  rig.play(drive, 0.15);
  rig.play(silent, 0.03);
  EXPECT_EQ(counts().submitted.drives, 100u);
  EXPECT_EQ(counts().completed.drives, 100u);
  EXPECT_EQ(shown, (std::vector<std::uint64_t>{100, 100}));
  rig.play(faint, 0.015);
  EXPECT_EQ(counts().completed.drives, 100u) << "too faint for a first step: nothing sounds";
  // One board takes nothing for a while: drives are replaced, and both boards miss the same ones.
  rig.faults[1]->takes_nothing = true;
  rig.play(drive, 0.15);
  EXPECT_LT(counts().completed.drives, 110u);
  EXPECT_EQ(counts().completed.drives, std::min(shown[0], shown[1]));
  const std::uint64_t before = counts().completed.drives;
  rig.play(faint, 0.015);
  EXPECT_EQ(counts().completed.drives, before) << "the board does not take the silence either";
  rig.faults[1]->takes_nothing = false;
  rig.play(silent, 0.03);
  EXPECT_LT(counts().completed.drives, 110u);
  EXPECT_EQ(counts().completed.drives, shown[0]);
  EXPECT_EQ(counts().completed.drives, shown[1]);
  EXPECT_EQ(counts().submitted.drives, counts().completed.drives);
  EXPECT_EQ(rig.violations(), "");
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
    EXPECT_TRUE(rig.silent_after(0.01));
    for (const auto& emulator : rig.emulators)
      EXPECT_FALSE(emulator->fpga().sounds_behind());
  }
}

TEST(OpenMpdBoard, ARampGoesFromFocusToFocusInSmallSteps) {
  OpenMpdRig rig({"EMU1", "EMU2"}), plain({"EMU1", "EMU2"});
  rig.ramp_s = 20e-3;
  rig.open();
  plain.open();
  const auto drive_to = [&](double x) { return focus_drive(rig.layout, {x, 0, 0.12}, array::Weighting::uniform); };
  rig.play(drive_to(0), 0.03);
  EXPECT_EQ(rig.board->counts().submitted.drives, 20u) << "a drive of several steps is one";
  EXPECT_EQ(rig.board->counts().completed.drives, 20u);
  std::vector<openmpd::Pulses> shown{rig.fpga(0).pulses()};
  rig.fpga(0).on_shown([&](double, const openmpd::Pulses& pulses) { shown.push_back(pulses); });
  for (const double x : {2e-3, 4e-3, 0.0}) {
    rig.play(drive_to(x), rig.slot_s);
    plain.play(drive_to(x), plain.slot_s);
    EXPECT_EQ(rig.fpga(0).pulses(), plain.fpga(0).pulses()) << "where it goes to";
    EXPECT_EQ(rig.fpga(1).pulses(), plain.fpga(1).pulses());
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
  EXPECT_TRUE(rig.silent_after(1e-3));
  EXPECT_EQ(rig.fpga(0).frames(), rig.fpga(1).frames());
  EXPECT_EQ(rig.violations(), "");
  // If slots are too short for two frames, a drive is one frame.
  OpenMpdRig fast;
  fast.ramp_s = 20e-3;
  fast.slot_s = 250e-6;
  fast.open();
  const std::uint64_t before = fast.fpga(0).frames();
  fast.play(focus_drive(fast.layout), 10 * fast.slot_s);
  EXPECT_EQ(fast.fpga(0).frames(), before + 10);
}

TEST(OpenMpdBoard, KeepsABoardThatGetsNothingFromCuttingTheNextFrame) {
  OpenMpdRig rig;
  rig.open();
  const std::uint64_t before = rig.fpga(0).frames();
  rig.tend_for(4);
  EXPECT_GE(rig.fpga(0).frames(), before + 7);
  EXPECT_FALSE(rig.sounds());
  // Not while something sounds: then the loop provides the drives, and the guard handles the loop's end.
  rig.play(focus_drive(rig.layout), 0.1);
  const std::uint64_t playing = rig.fpga(0).frames();
  rig.tend_for(0.5);
  EXPECT_EQ(rig.fpga(0).frames(), playing);
}

TEST(OpenMpdBoard, RefusesWhatCannotBePlayed) {
  const auto refuses = [](const std::string& argument, Exit code, const char* part, double slot_s = 1.5e-3,
                          const std::string& layout = "openmpd") {
    OpenMpdRig rig;
    rig.argument = argument;
    rig.slot_s = slot_s;
    rig.layout = array::load_layout(layout);
    EXPECT_ERROR(rig.open(), code, part);
  };
  refuses("NONE", Exit::failed, "no OpenMPD board has the serial number NONE: these are plugged in: EMU1");
  refuses("", Exit::usage, "SERIAL");
  refuses("A,,B", Exit::usage, "SERIAL");
  refuses("EMU1,EMU1", Exit::usage, "twice");
  refuses("EMU1,EMU2", Exit::usage, "has 1 OpenMPD boards, but 2 serial numbers");
  refuses("EMU1", Exit::usage, "--layout openmpd", 1.5e-3, on_off_board());
  refuses("EMU1", Exit::usage, "0.05 ms", 40e-6);
  refuses("EMU1", Exit::usage, "8.5 MB/s", 60e-6);
  EXPECT_EQ(openmpd::divider_for(1.5e-3), 4);
  EXPECT_EQ(openmpd::divider_for(250e-6), 4);
  EXPECT_EQ(openmpd::divider_for(100e-6), 2);
  EXPECT_EQ(openmpd::divider_for(50e-6), 1);
  // Sixteen boards at 10 kHz exceed a bus. At 4 kHz they do not, nor on two buses.
  for (const auto& [slot_s, buses, fault] :
       {std::tuple{100e-6, 1u, "16 boards on bus 1 need 81.9 MB/s"}, {250e-6, 1u, ""}, {200e-6, 2u, ""}}) {
    OpenMpdRig rig;
    rig.take_sixteen(buses);
    rig.slot_s = slot_s;
    const std::string line = error_of([&] { rig.open(); }, Exit::usage);
    EXPECT_EQ(line.empty(), *fault == '\0') << line;
    EXPECT_CONTAINS(line, fault);
  }
}

}  // namespace
}  // namespace palpa::test
