// SonicSurface: an independent decoder reads the encoder's bytes; and the board on a serial line.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "driver/guard/channel.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/line.hpp"
#include "driver/sonicsurface/machine.hpp"
#include "driver/sonicsurface/pty.hpp"
#include "driver/sonicsurface/wire.hpp"
#include "sonicsurface_rig.hpp"
#include "support/begins.hpp"
#include "support/ordinary_user.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::driver::sonicsurface {
namespace {

using namespace std::chrono_literals;
using test::expected_phase;
using test::some_drive;
using Rig = test::SonicSurfaceRig;
constexpr float pi = std::numbers::pi_v<float>;

TEST(SonicSurfaceWire, EachTransducerGetsItsPhase) {
  for (const auto& [boards, firmware] : {std::pair(std::size_t{1}, Firmware::plain),
                                         {std::size_t{1}, Firmware::tactile},
                                         {std::size_t{2}, Firmware::plain}}) {
    const bool tactile = firmware == Firmware::tactile;
    const Encoder encoder(boards, firmware);
    EmulatedBoards machine(boards, tactile);
    EXPECT_FALSE(machine.all_silent()) << "after power-up it sounds";
    const array::Drive drive = some_drive(boards);
    std::vector<std::uint8_t> frame(encoder.size());
    encoder.encode(drive, frame);
    machine.take(0, frame);
    for (std::size_t t = 0; t < drive.size(); ++t)
      ASSERT_EQ(machine.sounding(t / transducers, t % transducers), expected_phase(drive[t], tactile ? 16 : 32)) << t;
    machine.take(0, encoder.all_off());
    EXPECT_TRUE(machine.all_silent() && machine.all_silent_behind());
    EXPECT_EQ(machine.violations().count(), 0u);
  }
}

TEST(SonicSurfaceWire, IsOfTheBytesThatTheBoardsTake) {
  std::vector<std::uint8_t> expected;
  const auto expect = [&](std::initializer_list<std::uint8_t> selections) {
    for (int times = 0; times < 2; ++times) {
      for (const std::uint8_t selection : selections) {
        if (selection != 0) expected.push_back(selection);
        expected.push_back(254);
        expected.insert(expected.end(), 256, 32);
      }
      expected.push_back(253);
    }
  };
  expect({0});
  EXPECT_EQ(Encoder(1, Firmware::tactile).all_off(), expected);
  expected.clear();
  expect({193, 192});
  expected.insert(expected.end(), {192, 254, 32});
  EXPECT_EQ(Encoder(2, Firmware::plain).all_off(), expected);
  expected.clear();
  expect({192});
  expect({193});
  expected.insert(expected.end(), {192, 254, 32});
  EXPECT_EQ(Encoder(1, Firmware::plain).all_off(), expected);
  expected.clear();
  expect({192});
  EXPECT_EQ(Encoder(1, Firmware::plain).own_off(), expected) << "half of it";
  // The corners: top left, its neighbours, bottom right.
  EXPECT_EQ(slot_of(0), 0u);
  EXPECT_EQ(slot_of(1), 7u);
  EXPECT_EQ(slot_of(16), 4u);
  EXPECT_EQ(slot_of(255), 64u * 3 + 8 * 7 + 5);
  std::array<int, transducers> hits{};
  for (std::size_t t = 0; t < transducers; ++t)
    ++hits[slot_of(t)];
  EXPECT_TRUE(std::all_of(hits.begin(), hits.end(), [](int n) { return n == 1; }));
}

TEST(SonicSurfaceWire, PhasesAreDelaysAndACalibrationIsTakenOff) {
  const Encoder encoder(1, Firmware::plain, [] {
    std::vector<float> degrees(transducers, 0.0f);
    degrees[1] = 180;
    return degrees;
  }());
  array::Drive drive(transducers, {1.0f, 0.0f});
  drive[2].phase = -pi / 2;
  drive[3].phase = -1e-4f;
  drive[4].phase = pi;
  std::vector<std::uint8_t> frame(encoder.size());
  encoder.encode(drive, frame);
  EmulatedBoards machine(1, false);
  machine.take(0, frame);
  EXPECT_EQ(machine.sounding(0, 0), 0);
  EXPECT_EQ(machine.sounding(0, 1), 16);
  EXPECT_EQ(machine.sounding(0, 2), 24);
  EXPECT_EQ(machine.sounding(0, 3), 0);
  EXPECT_EQ(machine.sounding(0, 4), 16);
}

TEST(SonicSurfaceWire, ACeilingMutesTransducersEvenly) {
  const Encoder encoder(1, Firmware::plain);
  std::vector<std::uint8_t> frame(encoder.size());
  for (const float ceiling : {0.9f, 0.5f, 0.25f, 0.1f}) {
    array::Drive drive(transducers, {ceiling, 0.0f});
    drive[7].amplitude *= 0.7f;  // different amplitudes are played as uniform
    encoder.encode(drive, frame);
    EmulatedBoards machine(1, false);
    machine.take(0, frame);
    std::array<int, 4> quarters{};
    for (std::size_t t = 0; t < transducers; ++t)
      quarters[t / 128 * 2 + t % 16 / 8] += machine.sounding(0, t) != EmulatedBoards::silent ? 1 : 0;
    for (const int quarter : quarters)
      EXPECT_NEAR(quarter, 64 * ceiling, 4) << ceiling;
  }
}

TEST(SonicSurfaceEmulator, FindsWhatNobodyCanHaveMeant) {
  const auto violations = [](bool tactile, const std::vector<std::uint8_t>& bytes, double baud = 230400) {
    EmulatedBoards machine(1, tactile);
    machine.set_baud(0, baud);
    machine.take(0, bytes);
    return machine.violations().count();
  };
  std::vector<std::uint8_t> frame{254};
  frame.insert(frame.end(), 256, 4);
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
  std::vector<std::uint8_t> off{254}, on{254};
  off.insert(off.end(), 256, 32);
  on.insert(on.end(), 256, 3);
  const std::vector<std::uint8_t> swap{253};
  for (const auto& bytes : {off, swap, off, swap})
    machine.take(0, bytes);
  EXPECT_TRUE(machine.all_silent() && machine.all_silent_behind());
  machine.take(0, std::vector<std::uint8_t>{193});
  machine.take(0, on);
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

TEST(SonicSurfaceBoard, SilencesABoardThatWasLeftSounding) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.board = rig.make(12e-3, true);
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); }));
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, ABoardThatWasDeselectedHearsItAllTheSame) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  {
    const std::lock_guard held(rig.lock);
    rig.machine.take(0, std::vector<std::uint8_t>{193});  // from a pair's last frame
  }
  rig.board = rig.make(12e-3, true);
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); }));
  rig.board->play(0, rig.drive);
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  rig.board->all_off();
  rig.expect_silent_end();
}

TEST(SonicSurfaceWire, OneBoardsSilenceReachesASecondOneBehindIt) {
  EmulatedBoards machine(2, false);
  const Encoder encoder(1, Firmware::plain);
  machine.take(0, encoder.all_off());
  EXPECT_TRUE(machine.all_silent() && machine.all_silent_behind());
  std::vector<std::uint8_t> frame(encoder.size());
  encoder.encode(some_drive(1), frame);
  machine.take(0, frame);
  EXPECT_EQ(machine.sounding(0, 0), expected_phase(some_drive(1)[0], 32));
  EXPECT_EQ(machine.sounding(1, 0), EmulatedBoards::silent) << "the primary one alone plays";
  EXPECT_EQ(machine.violations().count(), 0u);
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
    std::vector<std::uint8_t> frame(c.encoder.size());
    c.encoder.encode(some_drive(c.encoder.size() > 300 ? 2 : 1), frame);
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
  rig.board = rig.make(12e-3, true);
  for (std::uint64_t s = 0; s < 20; ++s) {
    rig.drive[0].phase = static_cast<float>(s) / 10;
    rig.board->play(s, rig.drive);
  }
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  EXPECT_LE(rig.machine.swaps(), 5u) << "none queue";
  rig.board->play(20, rig.silence);
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); }));
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, BetweenPatternsItsOwnBoardIsSilencedAtTheEndAllAre) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.board = rig.make(12e-3, true);
  const auto silent = [&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); };
  const auto bytes_of = [&](const auto& act, const auto& done) {
    const std::uint64_t before = rig.machine.bytes();
    act();
    EXPECT_TRUE(rig.tend_until(done));
    rig.tend_until([] { return false; }, 60ms);
    return rig.machine.bytes() - before;
  };
  std::uint64_t slot = 0;
  const auto sound = [&] { rig.board->play(slot++, rig.drive); };
  const auto sounds = [&] { return rig.plays(rig.drive); };
  bytes_of([] {}, silent);
  EXPECT_EQ(bytes_of(sound, sounds), 258u);
  EXPECT_EQ(bytes_of([&] { rig.board->play(slot++, rig.silence); }, silent), 2 * 259u);
  EXPECT_EQ(bytes_of(sound, sounds), 258u);
  EXPECT_EQ(bytes_of([&] { rig.board->all_off(); }, silent), 4 * 259u + 3);
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, SilenceThatIsOnItsWayIsNotBegunAgain) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.board = rig.make(12e-3, true);
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.all_silent(); }));
  rig.board->play(0, rig.drive);
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  const std::uint64_t before = rig.machine.bytes();
  rig.board->play(1, rig.silence);
  rig.board->all_off();
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.bytes() >= before + 6 * 259u + 3; }))
      << rig.machine.bytes() - before << " bytes: both buffers of its own board, then of all";
  EXPECT_EQ(rig.machine.bytes(), before + 6 * 259u + 3);
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, WhatStandsStillIsModulatedByOneByte) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  rig.board = rig.make(1.5e-3, false);
  rig.plan(200);
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  const std::uint64_t bytes = rig.machine.bytes(), swaps = rig.machine.swaps();
  const double begin_s = monotonic_s();
  bool on = false, silent = false;
  std::uint64_t slot = 100;
  const auto swapped = [&] {
    on = on || rig.plays(rig.drive);
    silent = silent || rig.machine.all_silent();
    rig.board->play(++slot, rig.drive);
    return on && silent && rig.machine.swaps() >= swaps + 100;  // a quarter of a second
  };
  EXPECT_TRUE(rig.tend_until(swapped));
  const double after_s = monotonic_s() - begin_s;
  EXPECT_EQ(rig.machine.bytes() - bytes, rig.machine.swaps() - swaps) << "nothing but swaps";
  const double rate_hz = static_cast<double>(rig.machine.swaps() - swaps) / after_s;
  EXPECT_LE(rate_hz, 400 * 1.1) << "none in a burst";
  // A different pattern comes within a refresh, and never partly.
  rig.drive[3].phase += 1;
  rig.plan(200);
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  rig.board->all_off();
  EXPECT_TRUE(rig.tend_until([&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); }));
  const std::uint64_t at_rest = rig.machine.bytes();
  rig.tend_until([] { return false; }, 50ms);
  EXPECT_EQ(rig.machine.bytes(), at_rest) << "nothing more is sent";
  rig.board->play(slot, rig.drive);  // and it continues with the next drive
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  rig.board->all_off();
  rig.expect_silent_end();
}

TEST(SonicSurfaceBoard, RefusesWhatItCannotPlay) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  const std::string line = test::error_of([&] { rig.make(1.5e-3, true); }, Exit::usage);
  EXPECT_CONTAINS(line, "a frame takes 11.3 ms");
  EXPECT_CONTAINS(line, "--dwell 12ms");
  EXPECT_CONTAINS(line, "single-focus");
  rig.argument += ",fast";
  EXPECT_CONTAINS(test::error_of([&] { rig.make(12e-3, true); }, Exit::usage), "PORT,tactile");
  rig.argument = "/dev/null";
  EXPECT_CONTAINS(test::error_of([&] { rig.make(12e-3, true); }, Exit::failed), "serial port");
  rig.argument = "/dev/ttyNONE";
  EXPECT_CONTAINS(test::error_of([&] { rig.make(12e-3, true); }, Exit::failed), "/dev/ttyNONE: No such file");
  rig.argument = rig.pty.path();
  rig.layout = array::load_layout("openmpd");
  EXPECT_CONTAINS(test::error_of([&] { rig.make(12e-3, true); }), "one or two boards");
}

TEST(SonicSurfaceBoard, TakesACalibrationFromItsFolder) {
  const auto folder = test::scratch_folder("sonicsurface");
  EXPECT_TRUE(read_degrees("", 256).empty());
  EXPECT_CONTAINS(test::error_of([&] { read_degrees(folder, 256); }), "cannot be read");
  const auto write = [&](const std::string& text) { std::ofstream(folder / "sonicsurface.txt") << text; };
  write("0 180 -90\n");
  EXPECT_EQ(read_degrees(folder, 3), (std::vector<float>{0, 180, -90}));
  EXPECT_CONTAINS(test::error_of([&] { read_degrees(folder, 4); }), "has 3 numbers");
  write("0 x 3");
  EXPECT_CONTAINS(test::error_of([&] { read_degrees(folder, 3); }), "value 2 is not a number");
  write("0 400 3");
  EXPECT_CONTAINS(test::error_of([&] { read_degrees(folder, 3); }), "400 degrees");
}

TEST(SonicSurfaceLine, IsOnePrograms) {
  PALPA_TERMINAL_OR_SKIP();
  const Pty pty;
  ASSERT_EQ(chmod(pty.path().c_str(), 0666), 0);
  const test::OrdinaryUser user;  // root can open lines that other users cannot
  auto line = std::make_unique<Line>(pty.path());
  EXPECT_CONTAINS(test::error_of([&] { Line again(pty.path()); }, Exit::failed), "another program has it");
  line.reset();
  EXPECT_NO_THROW(Line(pty.path())) << "the program before has closed it";
}

TEST(SonicSurfaceBoard, ALineThatGoesAwayIsToldOnce) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  auto vanishing = std::make_unique<Pty>();
  rig.argument = vanishing->path();
  rig.board = rig.make(12e-3, true);
  vanishing.reset();
  std::uint64_t s = 0;
  const auto told = [&] {
    rig.board->play(s++, rig.drive);
    return !rig.notes.warnings.empty();
  };
  EXPECT_TRUE(test::begins(told));
  for (int more = 0; more < 20; ++more)
    told();
  EXPECT_EQ(rig.notes.warnings, (std::vector<std::string>{"the serial port is gone"}));
  rig.board->all_off();
  EXPECT_FALSE(rig.board->close()) << "nobody knows";
}

TEST(SonicSurfaceBoard, ALineThatComesBackIsSilencedBeforeItPlays) {
  PALPA_TERMINAL_OR_SKIP();
  Rig rig;
  const auto port = test::scratch_folder("sonicsurface-port") / "tty";
  auto vanishing = std::make_unique<Pty>();
  std::filesystem::create_symlink(vanishing->path(), port);
  rig.argument = port.string();
  rig.board = rig.make(12e-3, true);
  vanishing.reset();
  std::filesystem::remove(port);
  const auto gone = [&, s = std::uint64_t{0}]() mutable {
    rig.board->play(s++, rig.drive);
    return !rig.notes.warnings.empty();
  };
  EXPECT_TRUE(test::begins(gone));
  std::filesystem::create_symlink(rig.pty.path(), port);  // its board has sounded since it was switched on
  const bool silenced = rig.tend_until([&] { return rig.machine.all_silent() && rig.machine.all_silent_behind(); });
  EXPECT_TRUE(silenced);
  EXPECT_EQ(rig.notes.warnings, (std::vector<std::string>{"the serial port is gone", "the serial port is back"}));
  for (std::uint64_t s = 2000; s < 2020; ++s)
    rig.board->play(s, rig.drive);
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  rig.board->all_off();
  rig.expect_silent_end();
}

}  // namespace
}  // namespace palpa::driver::sonicsurface
