// OpenMPD boards with faults, with emulators on a bus in memory: silence, one line that describes the fault, and in
// step again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "driver/openmpd/openmpd_rig.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
namespace ftdi = driver::usb::ftdi;

/// Boards that play a drive, slot after slot.
struct PlayingRig : OpenMpdRig {
  explicit PlayingRig(std::vector<std::string> serials = {"EMU1"})
      : OpenMpdRig(std::move(serials)), drive(focus_drive(layout)) {
    open();
    play_on(0.05);
  }
  void play_on(double seconds) { play(drive, seconds); }
  const array::Drive drive;
};

/// After a fault: silent, reported once, and playing again within three seconds.
void expect_recovery(PlayingRig& rig, const std::string& said) {
  ASSERT_FALSE(rig.notes.warnings.empty());
  EXPECT_CONTAINS(rig.notes.warnings[0], said);
  rig.play_on(3);
  EXPECT_TRUE(rig.board->in_step());
  EXPECT_TRUE(rig.sounds());
  ASSERT_EQ(rig.notes.warnings.size(), 2u) << rig.notes.warnings[1];
  EXPECT_CONTAINS(rig.notes.warnings[1], "in step again");
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdFaults, UnpluggedAtAnyByteAndPluggedInAgain) {
  for (const std::size_t bytes : {1u, 255u, 256u, 257u, 511u, 512u, 700u, 1023u}) {
    PlayingRig rig;
    rig.faults[0]->unplug_after = bytes;
    rig.play_on(0.05);
    EXPECT_FALSE(rig.board->in_step());
    rig.play_on(2);
    *rig.faults[0] = {};
    std::vector<bool> silent;
    rig.fpga(0).on_shown([&](double, const openmpd::Pulses& pulses) {
      silent.push_back(std::all_of(pulses.begin(), pulses.end(), [](const auto& pulse) { return pulse.width == 0; }));
    });
    expect_recovery(rig, "gone");
    EXPECT_EQ(rig.fpga(0).dividers_set(), 2u) << "opened again: it may have lost its power";
    // The rest of the cut frame may show once, half silent. Then all-off frames come before anything sounds.
    const auto first_off = std::find(silent.begin(), silent.end(), true);
    EXPECT_LE(first_off - silent.begin(), 1) << bytes;
    EXPECT_LE(std::find(first_off, silent.end(), false) - first_off, 4);
    EXPECT_GE(std::find(first_off, silent.end(), false) - first_off, 2);
  }
}

TEST(OpenMpdFaults, OneBoardOfTwoUnpluggedSilencesBoth) {
  PlayingRig rig({"EMU1", "EMU2"});
  rig.faults[1]->unplug_after = 300;
  rig.play_on(0.02);
  EXPECT_FALSE(rig.fpga(0).sounds()) << "the one that is still there";
  rig.play_on(1);
  EXPECT_FALSE(rig.fpga(0).sounds());
  EXPECT_TRUE(rig.board->counts().out_of_reach);
  *rig.faults[1] = {};
  expect_recovery(rig, "EMU2");
  EXPECT_FALSE(rig.board->counts().out_of_reach);
  // Since they were silenced, both have had the same frames; the unplugged one missed the burst after its fault.
  EXPECT_EQ(rig.fpga(0).shown_s(), rig.fpga(1).shown_s());
  EXPECT_GT(rig.fpga(0).frames_in_step(), 500u);
  EXPECT_EQ(rig.fpga(0).frames_in_step(), rig.fpga(1).frames_in_step());
}

TEST(OpenMpdFaults, ABoardThatWaitsForAnotherNeverClearsItsBuffer) {
  PlayingRig rig({"EMU1", "EMU2"});
  rig.faults[1]->unplugged = true;
  rig.play_on(2.2);
  ASSERT_TRUE(rig.board->connections()[0]->in_step());
  const std::uint64_t frames = rig.fpga(0).frames();
  double longest_s = 0, last_s = rig.clock.now_s();
  const auto wait = [&](double seconds) {
    for (const double end_s = rig.clock.now_s() + seconds; rig.clock.now_s() < end_s;) {
      const std::size_t before = rig.faults[0]->bulk_bytes;
      rig.play_on(0.01);
      if (rig.faults[0]->bulk_bytes > before) last_s = rig.clock.now_s();
      longest_s = std::max(longest_s, rig.clock.now_s() - last_s);
    }
  };
  wait(3);
  EXPECT_EQ(rig.fpga(0).frames(), frames) << "frames are for all";
  EXPECT_FALSE(rig.fpga(0).sounds());
  *rig.faults[1] = {};
  while (!rig.board->in_step())
    wait(0.01);
  EXPECT_LT(longest_s, 0.5);
  expect_recovery(rig, "EMU2");
  EXPECT_EQ(rig.fpga(0).frames_in_step(), rig.fpga(1).frames_in_step());
}

TEST(OpenMpdFaults, WhatIsLeftOfAFrameNeverComesBehindTheNext) {
  for (const bool backwards : {false, true}) {
    PlayingRig rig;
    rig.faults[0]->takes_nothing = true;
    for (int times = 0; times < 2; ++times)
      rig.board->play(rig.slot++, rig.drive);
    *rig.faults[0] = {.cut_at = 100, .cuts_once = true, .reaped_backwards = backwards};
    rig.play_on(0.02);
    EXPECT_EQ(rig.faults[0]->cut_at, 0u) << "it was cut";
    EXPECT_FALSE(rig.sounds());
    // The two were on their way: they arrived as one invalid frame. No more came after them.
    const std::size_t violations = rig.emulators[0]->violations().count();
    ASSERT_EQ(rig.notes.warnings.size(), 1u);
    rig.play_on(3);
    EXPECT_TRUE(rig.board->in_step() && rig.sounds());
    EXPECT_EQ(rig.notes.warnings.size(), 2u);
    EXPECT_EQ(rig.emulators[0]->violations().count(), violations);
  }
}

TEST(OpenMpdFaults, ClosingTakesNoLongerThanItsPatience) {
  for (const double request_s : {0.1, 0.2, 0.24}) {
    PlayingRig rig;
    rig.faults[0]->unplugged = true;
    rig.play_on(0.01);
    *rig.faults[0] = {.request_s = request_s};
    rig.board->all_off();
    const double begin_s = rig.clock.now_s();
    EXPECT_FALSE(rig.board->close());
    EXPECT_LE(rig.clock.now_s() - begin_s, 0.851);
  }
}

TEST(OpenMpdFaults, SilenceThatIsStuckForAMomentAtTheEndStillComes) {
  for (const double stuck_s : {0.1, 0.26, 0.3}) {
    PlayingRig rig;
    rig.faults[0]->takes_nothing = true;
    rig.board->all_off();
    rig.clock.at(rig.clock.now_s() + stuck_s, [&] { rig.faults[0]->takes_nothing = false; });
    EXPECT_TRUE(rig.board->close()) << stuck_s;
    EXPECT_TRUE(rig.silent_after(5e-3)) << stuck_s;  // frames already in the kernel sound within that time
    EXPECT_EQ(rig.violations(), "") << stuck_s;
  }
}

TEST(OpenMpdFaults, ABoardThatTakesNothingIsSilentAsSoonAsItDoes) {
  PlayingRig rig;
  rig.faults[0]->takes_nothing = true;
  rig.play_on(1);
  ASSERT_EQ(rig.notes.warnings.size(), 1u);
  EXPECT_CONTAINS(rig.notes.warnings[0], "takes no bytes");
  rig.board->all_off();
  EXPECT_FALSE(rig.board->close()) << "nobody knows whether it is silent";
  rig.faults[0]->takes_nothing = false;
  rig.play_on(0.7);
  EXPECT_FALSE(rig.sounds());
  rig.play_on(2);
  EXPECT_TRUE(rig.sounds());
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdFaults, SilenceDoesNotWaitForABoardThatIsStuck) {
  for (const bool by_a_drive : {false, true}) {
    PlayingRig rig({"EMU1", "EMU2"});
    rig.faults[1]->takes_nothing = true;
    rig.play_on(0.02);
    EXPECT_TRUE(rig.fpga(0).sounds());
    const std::uint64_t before = rig.fpga(0).frames();
    for (int times = 0; times < 5; ++times) {
      by_a_drive ? rig.board->play(rig.slot++, array::Drive(512, {0, 0})) : rig.board->all_off();
      rig.clock.sleep_s(1e-3);
    }
    rig.look();
    EXPECT_FALSE(rig.fpga(0).sounds());
    EXPECT_EQ(rig.fpga(0).frames(), before + 1) << "once";
    rig.faults[1]->takes_nothing = false;
    rig.board->tend();
    rig.clock.sleep_s(5e-3);
    rig.board->tend();
    EXPECT_TRUE(rig.silent_after(5e-3));
    EXPECT_EQ(rig.fpga(0).frames(), rig.fpga(1).frames());
    rig.play_on(0.02);
    EXPECT_TRUE(rig.sounds());
    EXPECT_EQ(rig.fpga(0).frames(), rig.fpga(1).frames());
    EXPECT_TRUE(rig.notes.warnings.empty());
    EXPECT_EQ(rig.violations(), "");
  }
}

TEST(OpenMpdFaults, ADeviceThatAnswersSlowlyKeepsNobody) {
  PlayingRig rig({"EMU1", "EMU2"});
  rig.faults[1]->unplugged = true;
  rig.play_on(0.05);
  *rig.faults[1] = {};
  rig.faults[1]->request_s = 0.2;
  double longest_s = 0;
  for (int i = 0; i < 1000; ++i) {
    const double begin_s = rig.clock.now_s();
    rig.board->tend();
    longest_s = std::max(longest_s, rig.clock.now_s() - begin_s);
    rig.clock.sleep_s(5e-3);
  }
  EXPECT_GT(longest_s, 0.19) << "it was asked";
  EXPECT_LT(longest_s, 0.21) << "one request at a time";
  EXPECT_TRUE(rig.board->in_step());
  EXPECT_EQ(rig.violations(), "");
}

TEST(OpenMpdFaults, AtTheEndABoardThatIsBackIsSilencedAtOnce) {
  PlayingRig rig;
  rig.faults[0]->unplug_after = 100;
  rig.play_on(0.003);
  EXPECT_FALSE(rig.board->in_step());
  *rig.faults[0] = {};
  rig.board->all_off();
  const double begin_s = rig.clock.now_s();
  EXPECT_TRUE(rig.board->close());
  EXPECT_LT(rig.clock.now_s() - begin_s, 0.05);
  EXPECT_TRUE(rig.silent_after(0.01));
}

TEST(OpenMpdFaults, ASuspendedComputerIsNoFaultOfTheBoard) {
  PlayingRig rig;
  rig.faults[0]->takes_nothing = true;
  rig.board->play(rig.slot++, rig.drive);
  rig.clock.sleep_s(3);  // the computer was suspended
  rig.board->tend();
  rig.faults[0]->takes_nothing = false;
  rig.play_on(0.05);
  EXPECT_TRUE(rig.board->in_step());
  EXPECT_TRUE(rig.notes.warnings.empty());
}

TEST(OpenMpdFaults, AStalledEndpointIsClearedAndResynchronisedOnceItsRequestsAreAnswered) {
  for (const bool answered : {true, false}) {
    PlayingRig rig;
    rig.faults[0]->stalled = true;
    rig.faults[0]->refuses_requests = !answered;
    rig.play_on(answered ? 0.02 : 1);
    EXPECT_FALSE(rig.board->in_step());
    EXPECT_FALSE(answered && rig.sounds());
    rig.faults[0]->refuses_requests = false;
    expect_recovery(rig, "refuses");
    EXPECT_EQ(rig.fpga(0).dividers_set(), 1u) << "only when it is opened";
  }
}

TEST(OpenMpdFaults, EachTroubleIsToldWithItsOwnReason) {
  PlayingRig rig;
  rig.faults[0]->takes_nothing = true;
  rig.play_on(1);
  *rig.faults[0] = {};
  rig.play_on(3);
  ASSERT_TRUE(rig.board->in_step());
  rig.notes.warnings.clear();
  rig.faults[0]->stalled = rig.faults[0]->refuses_requests = true;
  rig.play_on(1);
  rig.faults[0]->refuses_requests = false;
  expect_recovery(rig, "refuses");
}

TEST(OpenMpdFaults, ShortWritesGoOnAtTheirByte) {
  for (std::size_t cut = 1; cut < 512; ++cut) {
    OpenMpdRig rig;
    rig.open();
    rig.faults[0]->cut_at = cut;
    const array::Drive drive = focus_drive(rig.layout);
    const std::uint64_t before = rig.fpga(0).frames();
    rig.play(drive, 0.006);
    ASSERT_EQ(rig.fpga(0).frames() - before, 4u) << cut;
    ASSERT_TRUE(rig.board->in_step()) << cut;
    ASSERT_EQ(rig.violations(), "") << cut;
    ASSERT_TRUE(rig.sounds());
  }
}

TEST(OpenMpdFaults, TheNextStartFindsItsStepWhateverTheLastOneLeft) {
  PlayingRig fresh;
  for (const std::size_t left : {1u, 255u, 511u, 513u, 1000u}) {
    OpenMpdRig rig;
    {  // a run that ended within a frame, without a guard
      const auto device = rig.bus.open(rig.bus.list([](auto, auto) { return true; }).entries.at(0), ftdi::endpoint_out);
      for (const driver::usb::Setup& setup : ftdi::ready_requests)
        ASSERT_EQ(device->request(setup), driver::usb::Outcome::done);
      std::vector<std::uint8_t> residue(left, 0x21);
      residue[0] = 0x80;
      ASSERT_EQ(device->submit(0, residue), driver::usb::Outcome::done);
      ASSERT_TRUE(device->reap().has_value());
    }
    rig.clock.sleep_s(0.02);
    rig.open();
    rig.look();
    EXPECT_FALSE(rig.sounds());
    rig.play(fresh.drive, 0.02);
    EXPECT_EQ(rig.fpga(0).pulses(), fresh.fpga(0).pulses()) << left;
    rig.board->all_off();
    EXPECT_TRUE(rig.board->close());
    EXPECT_TRUE(rig.silent_after(1e-3));
  }
}

TEST(OpenMpdFaults, SomethingElseBehindTheIdsIsRefused) {
  for (const auto& [channel, what] :
       {std::pair{ftdi::Channel::uart, "serial (UART)"}, {ftdi::Channel::blank, "blank"}}) {
    OpenMpdRig rig({"PROBE"}, channel);
    EXPECT_ERROR(rig.open(), Exit::failed, what);
    EXPECT_EQ(rig.faults[0]->bulk_bytes, 0u) << "a probe gets no byte";
  }
  // Something else takes the board's place while it is away.
  openmpd::EmulatedBoard probe("EMU1", ftdi::Channel::uart);
  PlayingRig rig;
  rig.faults[0]->unplugged = true;
  const auto& faults = rig.bus.plug(probe);
  rig.play_on(2);
  EXPECT_EQ(faults.bulk_bytes, 0u);
  EXPECT_FALSE(rig.board->in_step());
}

TEST(OpenMpdFaults, SerialNumbersThatSeveralShareNeedAPlace) {
  openmpd::EmulatedBoard twin("23");
  OpenMpdRig rig({"23"});
  const auto& twin_faults = rig.bus.plug(twin);
  EXPECT_ERROR(rig.open(), Exit::usage, "23@1-1,23@1-2");
  rig.argument = "23@1-2";
  rig.open();
  EXPECT_GT(twin_faults.bulk_bytes, 0u);
  EXPECT_EQ(rig.faults[0]->bulk_bytes, 0u);
  OpenMpdRig pair({"23", "23"});
  pair.argument = "23@1-2,23@1-1";
  pair.open();
  array::Drive drive(512, {0, 0});
  drive[0].amplitude = 1;
  pair.play(drive, 0.02);
  EXPECT_FALSE(pair.fpga(0).sounds());
  EXPECT_TRUE(pair.fpga(1).sounds()) << "the layout's first board is the one named first";
}

}  // namespace
}  // namespace palpa::test
