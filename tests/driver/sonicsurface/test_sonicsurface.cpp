// SonicSurface: an independent decoder reads the encoder's bytes; and the board on a serial line, in a time that passes
// only while somebody waits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/board_types.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/emulated/boards.hpp"
#include "driver/sonicsurface/emulated/pty.hpp"
#include "driver/sonicsurface/line.hpp"
#include "driver/sonicsurface/wire.hpp"
#include "sonicsurface_rig.hpp"
#include "support/files.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::sonicsurface {
namespace {

using test::some_drive;
using Rig = test::SonicSurfaceRig;
using Opened = test::Opened<Rig>;

std::vector<std::uint8_t> frame_of(const Encoder& encoder, const array::Drive& drive) {
  std::vector<std::uint8_t> frame(encoder.size());
  encoder.encode(drive, frame);
  return frame;
}

/// A frame without its swap: the same byte for each transducer.
std::vector<std::uint8_t> filled(std::uint8_t byte) {
  std::vector<std::uint8_t> frame(257, byte);
  frame[0] = 254;
  return frame;
}

TEST(SonicSurfaceWire, TakesAsLongAsItsRecordSays) {
  for (const std::size_t boards : {1UL, 2UL})
    EXPECT_DOUBLE_EQ(array::find_board_type("sonicsurface")->moving_slot_s(boards), seconds_of(frame_size(boards)));
}

TEST(SonicSurfaceWire, EachTransducerGetsItsPhase) {
  struct Case {
    std::size_t there, boards;  ///< on the line; for the encoder
    Firmware firmware;
  };
  for (const auto& [there, boards, firmware] : {Case{1, 1, Firmware::plain}, Case{1, 1, Firmware::tactile},
                                                Case{2, 2, Firmware::plain}, Case{2, 1, Firmware::plain}}) {
    const bool tactile = firmware == Firmware::tactile;
    const Encoder encoder(boards, firmware, {}, 16.5 / 32);
    EmulatedBoards machine(there, tactile);
    EXPECT_FALSE(machine.all_silent()) << "after power-up it sounds";
    machine.take(0, encoder.all_off());
    EXPECT_TRUE(machine.all_silent() && machine.all_silent_behind());
    const array::Drive drive = some_drive(boards);
    machine.take(0, frame_of(encoder, drive));
    for (std::size_t t = 0; t < drive.size(); ++t)
      ASSERT_TRUE(test::sounds_as(machine, t / transducers, t % transducers, drive[t], tactile ? 16 : 32)) << t;
    EXPECT_TRUE(boards == there || machine.sounding(1, 0) == EmulatedBoards::silent) << "the primary one alone plays";
    EXPECT_EQ(machine.violations().count(), 0u);
  }
}

TEST(SonicSurfaceWire, ATransducersPlaceInAFrameIsThatOfTheBoards) {
  // The corners, seen from the side that emits sound: bottom left, its neighbours, top right.
  EXPECT_EQ(slot_of(0), 0u);
  EXPECT_EQ(slot_of(1), 7u);
  EXPECT_EQ(slot_of(16), 4u);
  EXPECT_EQ(slot_of(255), 64u * 3 + 8 * 7 + 5);
  std::array<int, transducers> hits{};
  for (std::size_t t = 0; t < transducers; ++t)
    ++hits[slot_of(t)];
  EXPECT_TRUE(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; }));
}

TEST(SonicSurfaceWire, LateOutputsGetAStepLessAndTheSecondaryItsLagLess) {
  const auto phases = [](const Encoder& encoder, std::size_t boards) {
    EmulatedBoards machine(boards, false);
    machine.take(0, encoder.all_off());
    machine.take(0, frame_of(encoder, array::Drive(boards * transducers, {1.0f, 0.0f})));
    std::vector<int> sent;
    for (std::size_t t = 0; t < boards * transducers; ++t)
      sent.push_back(machine.sounding(t / transducers, t % transducers));
    return sent;
  };
  const std::vector<int> one = phases(Encoder(1, Firmware::plain), 1);
  EXPECT_EQ(std::ranges::count(one, 31), 32) << "one output of each of the 32 registers";
  EXPECT_EQ(std::ranges::count(one, 0), 224);
  EXPECT_EQ(one[16 + 1], 31) << "column 1, row 1";
  const std::vector<int> tactile = phases(Encoder(1, Firmware::tactile), 1);
  EXPECT_EQ(tactile[16 + 1], 30) << "steps are twice as large";
  const std::vector<int> pair = phases(Encoder(2, Firmware::plain, {}, 16.5 / 32), 2);
  EXPECT_EQ(pair[0], 0);
  EXPECT_EQ(pair[transducers], 16) << "16.5 of 32 steps earlier is 15.5";
  EXPECT_EQ(pair[transducers + 17], 15);
  EXPECT_EQ(phases(Encoder(2, Firmware::plain), 2)[transducers], 0);
}

TEST(SonicSurfaceWire, ACalibrationIsTakenOffAndPhasesRoundToTheNearestStep) {
  std::vector<float> degrees(transducers, 0.0f);
  degrees[1] = 180;
  degrees[3] = 90;  // a quarter late: it begins a quarter earlier
  array::Drive drive(transducers, {1.0f, 0.0f});
  drive[2].phase = -1e-4f;
  EmulatedBoards machine(1, false);
  machine.take(0, frame_of(Encoder(1, Firmware::plain, degrees), drive));
  EXPECT_EQ(machine.sounding(0, 0), 0);
  EXPECT_EQ(machine.sounding(0, 1), 16);
  EXPECT_EQ(machine.sounding(0, 2), 0);
  EXPECT_EQ(machine.sounding(0, 3), 24);
  // Each of two boards has its own values.
  degrees.resize(2 * transducers, 180.0f);
  degrees[transducers + 1] = 90;
  drive.assign(2 * transducers, {1.0f, 0.0f});
  EmulatedBoards pair(2, false);
  const Encoder encoder(2, Firmware::plain, degrees);
  pair.take(0, encoder.all_off());
  pair.take(0, frame_of(encoder, drive));
  for (const auto& [board, transducer, step] : {std::array{0, 0, 0}, {0, 1, 16}, {1, 0, 16}, {1, 1, 24}})
    EXPECT_EQ(pair.sounding(static_cast<std::size_t>(board), static_cast<std::size_t>(transducer)), step) << board;
}

TEST(SonicSurfaceEmulator, ReportsInvalidBytes) {
  const auto violations = [](bool tactile, const std::vector<std::uint8_t>& bytes, double baud = 230400) {
    EmulatedBoards machine(1, tactile);
    machine.set_baud(0, baud);
    machine.take(0, bytes);
    return machine.violations().count();
  };
  const auto frame = filled(4);
  auto longer = frame, odd = frame, loud = frame;
  longer.push_back(4);
  odd[9] = 5;
  loud[9] = 40;
  EXPECT_EQ(violations(false, frame), 0u);
  EXPECT_EQ(violations(false, longer), 1u);
  EXPECT_EQ(violations(false, odd), 0u);
  EXPECT_EQ(violations(true, odd), 1u);
  EXPECT_EQ(violations(false, loud), 1u);
  EXPECT_EQ(violations(false, {150}), 1u);
  EXPECT_EQ(violations(false, {254, 1, 2, 253}), 1u);
  EXPECT_EQ(violations(true, {0xa5}), 1u);
  EXPECT_EQ(violations(false, {}, 115200), 1u);
}

TEST(SonicSurfaceEmulator, ASwapExchangesTheBuffersAndHitsAllBoards) {
  EmulatedBoards machine(2, false);
  const std::vector<std::uint8_t> swap{253};
  for (const auto& bytes : {filled(32), swap, filled(32), swap})
    machine.take(0, bytes);
  EXPECT_TRUE(machine.all_silent() && machine.all_silent_behind());
  machine.take(0, std::vector<std::uint8_t>{193});
  machine.take(0, filled(3));
  EXPECT_TRUE(machine.all_silent());
  machine.take(0, swap);
  EXPECT_EQ(machine.sounding(0, 0), EmulatedBoards::silent) << "only the secondary board was selected";
  EXPECT_EQ(machine.sounding(1, 0), 3);
  machine.take(0, swap);
  EXPECT_TRUE(machine.all_silent());
  machine.take(0, swap);
  EXPECT_FALSE(machine.all_silent());
  EXPECT_EQ(machine.violations().count(), 0u);
}

TEST(SonicSurfaceBoard, ABoardThatWasDeselectedHearsItAllTheSame) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.machine.take(0, std::vector<std::uint8_t>{193});  // from a pair's last frame
  rig.open();
  EXPECT_TRUE(rig.becomes_silent());
  rig.board->play(0, rig.drive);
  EXPECT_TRUE(rig.plays_its_drive());
  rig.end_silent();
}

TEST(SonicSurfaceWire, BothBuffersAreSilentWhateverTheFirmwareIsAndWhateverItWasTakenFor) {
  struct Case {
    const char* name;
    std::size_t boards;  ///< on the line
    bool tactile;
    Encoder encoder;  ///< as it was when it was opened
  };
  const Case cases[] = {{"plain as plain", 1, false, Encoder(1, Firmware::plain)},
                        {"plain as tactile", 1, false, Encoder(1, Firmware::tactile)},
                        {"tactile as plain", 1, true, Encoder(1, Firmware::plain)},
                        {"tactile as tactile", 1, true, Encoder(1, Firmware::tactile)},
                        {"tactile as a pair", 1, true, Encoder(2, Firmware::plain)},
                        {"a pair as one", 2, false, Encoder(1, Firmware::plain)},
                        {"a pair as a pair", 2, false, Encoder(2, Firmware::plain)},
                        {"a pair as tactile", 2, false, Encoder(1, Firmware::tactile)}};
  for (const Case& c : cases) {
    const auto frame = frame_of(c.encoder, some_drive(c.encoder.size() > 300 ? 2 : 1));
    // At any place of a frame at which the previous program may have left it.
    for (std::size_t left_after = 0; left_after <= frame.size(); ++left_after) {
      EmulatedBoards machine(c.boards, c.tactile);
      machine.take(0, frame);
      machine.take(0, std::span(frame).first(left_after));
      machine.take(0, c.encoder.all_off());
      ASSERT_TRUE(machine.all_silent() && machine.all_silent_behind()) << c.name << ", left after " << left_after;
      machine.take(0, std::vector<std::uint8_t>{253});
      ASSERT_TRUE(machine.all_silent()) << c.name;
    }
  }
}

TEST(SonicSurfaceBoard, PlaysTheNewestDriveAndSilenceAtOnce) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.open();
  for (std::uint64_t s = 0; s < 20; ++s) {
    rig.drive[0].phase = static_cast<float>(s) / 10;
    rig.board->play(s, rig.drive);
  }
  EXPECT_TRUE(rig.plays_its_drive());
  const auto counts = [&] { return rig.board->counts(); };
  EXPECT_TRUE(rig.tend_until([&] { return counts().completed.drives == counts().submitted.drives; }));
  EXPECT_GE(counts().submitted.drives, 1u);
  EXPECT_LE(counts().submitted.drives, 2u) << "of twenty the newest, and one on its way before";
  EXPECT_TRUE(rig.comes_to_rest());
  EXPECT_LE(rig.machine.swaps(), 5u) << "none queue";
  rig.board->play(20, rig.silence);
  EXPECT_TRUE(rig.becomes_silent());
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, BetweenPatternsItsOwnBoardIsSilencedAndAtTheEndAllAre) {
  PALPA_TERMINAL_OR_SKIP();
  Opened rig;
  const auto silent = [&] { return rig.silent(); };
  std::uint64_t all = 0;
  const auto bytes_of = [&](const auto& act, const auto& done) {
    act();
    EXPECT_TRUE(rig.tend_until(done));
    EXPECT_TRUE(rig.comes_to_rest());
    return rig.machine.bytes() - std::exchange(all, rig.machine.bytes());
  };
  std::uint64_t slot = 0;
  const auto sound = [&] { rig.board->play(slot++, rig.drive); };
  const auto sounds = [&] { return rig.plays(rig.drive); };
  bytes_of([] {}, silent);
  EXPECT_EQ(bytes_of(sound, sounds), 258u);
  EXPECT_EQ(bytes_of([&] { rig.board->play(slot++, rig.silence); }, silent), 2 * 259u);
  EXPECT_EQ(bytes_of(sound, sounds), 258u);
  EXPECT_EQ(bytes_of([&] { rig.board->all_off(); }, silent), 4 * 259u + 3);
  EXPECT_EQ(bytes_of(sound, sounds), 258u);
  const auto twice = [&] {
    rig.board->play(slot++, rig.silence);
    rig.board->all_off();
  };
  EXPECT_EQ(bytes_of(twice, silent), 6 * 259u + 3) << "silence that is on its way is not begun again";
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, WhatStandsStillIsModulatedByOneByte) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.open_still();
  const auto counts = [&] { return rig.board->counts(); };
  rig.plan(200);
  std::uint64_t slot = 100;
  EXPECT_TRUE(rig.tend_until([&] {
    rig.board->play(slot++, rig.drive);
    return counts().completed.plans == 1;
  }));
  const BoardCounts begun = counts();
  const std::uint64_t first = slot;
  EXPECT_EQ(begun.submitted.plans, 1u);
  EXPECT_GT(begun.starting, 0u) << "nothing is heard before both buffers were silenced and the frame is there";
  EXPECT_TRUE(rig.plays_its_drive());
  const auto swaps = [&] { return rig.machine.swaps(); };
  const auto not_swaps = [&] { return rig.machine.bytes() - rig.machine.swaps(); };
  const std::uint64_t before = not_swaps(), first_swap = swaps();
  bool on = false, silent = false;
  const auto swapped = [&] {
    on = on || rig.plays(rig.drive);
    silent = silent || rig.machine.all_silent();
    rig.board->play(slot++, rig.drive);
    return on && silent && rig.machine.swaps() >= first_swap + 100;  // a quarter of a second
  };
  EXPECT_TRUE(rig.tend_until(swapped));
  EXPECT_EQ(not_swaps(), before) << "nothing but swaps";
  EXPECT_EQ(counts().completed.drives - begun.completed.drives, slot - first) << "each is the plan's";
  EXPECT_EQ(counts().starting, begun.starting);
  // A guard that got no processor for a while; nothing is on the line any more.
  rig.clock.sleep_s(0.2);
  const std::uint64_t paused = swaps();
  for (int i = 0; i < 20; ++i, rig.clock.sleep_s(0.1e-3))
    rig.board->tend();
  rig.clock.sleep_s(0.05);
  EXPECT_LE(swaps() - paused, 2u) << "late swaps do not come in a burst";
  // A different pattern comes within a refresh, and never partly.
  rig.drive[3].phase += 1;
  rig.plan(200);
  EXPECT_TRUE(rig.plays_its_drive());
  rig.board->all_off();
  EXPECT_TRUE(rig.becomes_silent());
  EXPECT_TRUE(rig.comes_to_rest()) << "nothing more is sent";
  rig.board->play(slot, rig.drive);  // and it continues with the next drive
  EXPECT_TRUE(rig.plays_its_drive());
  rig.end_silent();
}

// A new pattern is heard when it is there, so that it must not come in the middle of a pause.
TEST(SonicSurfaceBoard, ASlowModulationKeepsItsPausesWhileAFingerMoves) {
  PALPA_TERMINAL_OR_SKIP();
  for (const double hz : {2.0, 20.0}) {
    SCOPED_TRACE(hz);
    Rig rig;
    rig.open_still();
    rig.plan(hz);
    EXPECT_TRUE(rig.plays_its_drive());
    int steps = 0, silent = 0, changes = 0;
    bool was = false;
    const double until_s = rig.clock.now_s() + 3;
    for (; rig.clock.now_s() < until_s; ++steps) {
      if (steps % 16 == 0) {
        rig.drive[3].phase += 0.4F;
        rig.plan(hz);
      }
      rig.board->tend();
      const bool is = rig.machine.all_silent();
      silent += is ? 1 : 0;
      changes += is != was ? 1 : 0;
      was = is;
      rig.clock.sleep_s(1e-3);
    }
    EXPECT_NEAR(static_cast<double>(silent) / steps, 0.5, 0.1);
    EXPECT_NEAR(changes, 2 * hz * 3, 0.05 * 2 * hz * 3 + 1);
    rig.end_silent();
  }
}

TEST(SonicSurfaceBoard, SilenceDoesNotWaitBehindWhatTheKernelStillHas) {
  PALPA_TERMINAL_OR_SKIP();
  Opened rig;
  EXPECT_TRUE(rig.becomes_silent());
  EXPECT_TRUE(rig.comes_to_rest());
  const std::uint64_t before = rig.machine.bytes();
  rig.takes = false;
  for (std::uint64_t slot = 0; slot < 40; ++slot) {
    rig.board->play(slot, rig.drive);
    rig.clock.sleep_s(12e-3);
    rig.board->tend();
  }
  rig.board->play(40, rig.silence);
  rig.takes = true;
  EXPECT_TRUE(rig.becomes_silent());
  EXPECT_TRUE(rig.comes_to_rest());
  // What the other end of a pseudo terminal has got, at most 8191 bytes, cannot be taken back.
  EXPECT_LT(rig.machine.bytes() - before, 40 * 258u);
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
}

/// A pseudo terminal takes some frames more than its reader, as an adapter does that hangs.
TEST(SonicSurfaceBoard, CountsNothingWhileTheLineTakesNoBytes) {
  PALPA_TERMINAL_OR_SKIP();
  Opened rig;
  EXPECT_TRUE(rig.becomes_silent());
  rig.takes = false;
  std::uint64_t slot = 0, since = 0;
  const auto completed = [&] { return rig.board->counts().completed.drives; };
  double changed_s = rig.clock.now_s();
  const auto stands_still = [&] {
    rig.board->play(slot++, rig.drive);
    if (std::exchange(since, completed()) != completed()) changed_s = rig.clock.now_s();
    return rig.clock.now_s() - changed_s > 0.2;
  };
  EXPECT_TRUE(rig.tend_until(stands_still)) << "the last frames wait for a line that takes nothing";
  EXPECT_LT(completed(), 200u);
  rig.board->all_off();
}

TEST(SonicSurfaceBoard, RefusesWhatItCannotPlay) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  for (const char* part : {"a frame takes 11.3 ms", "--dwell 12ms", "single-focus"})
    EXPECT_ERROR(rig.make(1.5e-3, true), Exit::usage, part);
  const auto refuses = [&](const std::string& argument, Exit code, const std::string& part) {
    rig.argument = argument;
    EXPECT_ERROR(rig.open(), code, part);
  };
  refuses(rig.path() + ",fast", Exit::usage, "PORT,tactile");
  refuses(rig.path() + ",lag=0.5", Exit::usage, "but the link has one board: leave it out");
  for (const char* both : {",tactile,lag=0.5", ",lag=0.5,tactile"})
    refuses(rig.path() + both, Exit::usage, "with the tactile firmware there is one board");
  refuses(rig.path() + ",lag=0.5,fast", Exit::usage,
          "lag= comes last, after its boards and other words: " + rig.path() + ",fast,lag=0.5");
  refuses("/dev/null", Exit::failed, "serial port");
  refuses("/dev/ttyNONE", Exit::failed, "/dev/ttyNONE: No such file");
  rig.layout = array::load_layout("openmpd");
  refuses(rig.path(), Exit::bad_input, "one or two boards");
}

TEST(SonicSurfaceBoard, TakesACalibrationFromItsFolder) {
  const auto folder = test::scratch_folder("sonicsurface");
  EXPECT_TRUE(read_degrees("", 256).empty());
  EXPECT_REFUSED(read_degrees(folder, 256), "cannot be read");
  const auto read = [&](const std::string& text, std::size_t count) {
    test::write_text(folder / "sonicsurface.txt", text);
    return read_degrees(folder, count);
  };
  EXPECT_EQ(read("0 180 -90\n", 3), (std::vector<float>{0, 180, -90}));
  EXPECT_EQ(read("\xEF\xBB\xBF+0 +180\r\n-90\r\n", 3), (std::vector<float>{0, 180, -90}));
  EXPECT_REFUSED(read(std::string("\xFF\xFE") + std::string("0\0 \0", 4), 1), "is text in UTF-16; save it as UTF-8");
  EXPECT_REFUSED(read("0 180 -90\n", 4), "has 3 numbers");
  EXPECT_REFUSED(read("0 x 3", 3), "value 2 is not a number");
  EXPECT_REFUSED(read("0 400 3", 3), "400 degrees");
}

TEST(SonicSurfaceBoard, ALineThatGoesAwayIsToldOnceAndSilencedWhenItIsBack) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  const auto port = test::scratch_folder("sonicsurface-port") / "tty";
  auto vanishing = std::make_unique<Pty>();
  std::filesystem::create_symlink(vanishing->path(), port);
  rig.argument = port.string();
  rig.open();
  vanishing.reset();
  std::filesystem::remove(port);
  std::uint64_t slot = 0;
  const auto told = [&] {
    rig.board->play(slot++, rig.drive);
    return !rig.notes.warnings.empty();
  };
  EXPECT_TRUE(rig.clock.passes_until(told));
  for (int more = 0; more < 20; ++more)
    told();
  EXPECT_EQ(rig.notes.warnings, (std::vector<std::string>{"the serial port is gone"}));
  EXPECT_TRUE(rig.board->counts().out_of_reach);
  rig.board->all_off();
  EXPECT_FALSE(rig.board->close()) << "nobody knows";
  std::filesystem::create_symlink(rig.path(), port);  // its board has sounded since it was switched on
  EXPECT_TRUE(rig.becomes_silent());
  EXPECT_EQ(rig.notes.warnings, (std::vector<std::string>{"the serial port is gone", "the serial port is back"}));
  for (int more = 0; more < 20; ++more)
    told();
  EXPECT_TRUE(rig.plays_its_drive());
  rig.end_silent();
}

}  // namespace
}  // namespace palpa::driver::sonicsurface
