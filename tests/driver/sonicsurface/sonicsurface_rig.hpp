// Emulated SonicSurface boards on a pseudo terminal, in real time or in a test's own time; and a board on it as its
// guard has it.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numbers>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "base/system/descriptor.hpp"
#include "driver/rig_parts.hpp"
#include "driver/served_clock.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/emulated/boards.hpp"
#include "driver/sonicsurface/emulated/pty.hpp"
#include "driver/sonicsurface/wire.hpp"

namespace palpa::test {

/// One board on a serial line, which sounds from power-up, in real time.
class SonicSurfaceLine {
 public:
  SonicSurfaceLine() : thread_([this] { pty_.serve(machine, stop_, lock); }) {}
  ~SonicSurfaceLine() { end(); }
  SonicSurfaceLine(const SonicSurfaceLine&) = delete;
  SonicSurfaceLine& operator=(const SonicSurfaceLine&) = delete;

  const std::string& path() const { return pty_.path(); }
  /// Both of its buffers. The lock must be held.
  bool silent() const { return machine.all_silent() && machine.all_silent_behind(); }
  bool falls_silent() {
    return becomes(lock, [this] { return silent(); });
  }
  /// Whether a program's pattern sounds, between the pauses of a modulation. A program first silences both buffers,
  /// which takes two swaps. That state may be too short to be seen.
  bool sounds() {
    return becomes(lock, [this] { return machine.swaps() > 2 && !machine.all_silent(); });
  }
  /// Takes no more bytes.
  void end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  driver::sonicsurface::EmulatedBoards machine{1, false};
  std::mutex lock;

 private:
  driver::sonicsurface::Pty pty_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

inline array::Drive some_drive(std::size_t boards) {
  array::Drive drive(boards * driver::sonicsurface::transducers);
  for (std::size_t t = 0; t < drive.size(); ++t)
    drive[t] = {1.0f,
                static_cast<float>(static_cast<double>(t * 37 % 128) / 128 * 2 * std::numbers::pi - std::numbers::pi)};
  drive[5].amplitude = 0;
  return drive;
}

/// Whether the transducer sounds as the drive asks, to the nearest of that many phase steps.
inline bool sounds_as(const driver::sonicsurface::EmulatedBoards& machine, std::size_t board, std::size_t transducer,
                      const array::TransducerDrive& wanted, int steps = 32) {
  const int phase = machine.sounding(board, transducer);
  if (wanted.amplitude == 0 || phase == driver::sonicsurface::EmulatedBoards::silent)
    return (wanted.amplitude == 0) == (phase == driver::sonicsurface::EmulatedBoards::silent);
  const double heard = phase / 32.0 + machine.late_periods(board, transducer);
  const double off = std::remainder(heard - wanted.phase / (2 * std::numbers::pi), 1.0);
  return std::abs(off) * steps < 0.55;  // the secondary's lag is not a whole number of steps
}

/// A line that carries bytes at the speed of its port while a clock passes, and a board on it as its guard has it. Only
/// a pseudo terminal has the kernel's part of a line; one that is read finds all that was written.
struct SonicSurfaceRig {
  driver::sonicsurface::EmulatedBoards machine{1, false};
  ServedClock clock{[this] { serve(); }};
  bool takes = true;  ///< else an adapter that hangs
  array::Layout layout = array::load_layout("sonicsurface");
  std::string argument, files;
  KeptNotes notes;
  std::unique_ptr<driver::Board> board;
  array::Drive drive = some_drive(1), silence = array::Drive(driver::sonicsurface::transducers, {0.0f, 0.0f});

  SonicSurfaceRig() {
    int master = -1, slave = -1;
    std::array<char, 64> name{};
    EXPECT_EQ(openpty(&master, &slave, name.data(), nullptr, nullptr), 0);
    master_ = Descriptor(master);
    slave_ = Descriptor(slave);  // stays open, because the last one that closes it takes what was not read yet
    termios raw{};
    tcgetattr(master, &raw);
    cfmakeraw(&raw);
    tcsetattr(master, TCSANOW, &raw);
    fcntl(master, F_SETFL, O_NONBLOCK);
    path_ = argument = name.data();
  }
  SonicSurfaceRig(const SonicSurfaceRig&) = delete;
  SonicSurfaceRig& operator=(const SonicSurfaceRig&) = delete;

  const std::string& path() const { return path_; }
  std::unique_ptr<driver::Board> make(double slot_s, bool foci_move) {
    return driver::sonicsurface::open_board({argument, files, layout, slot_s, foci_move}, notes, clock);
  }
  /// For foci that move, slow enough for a frame each.
  void open() { board = make(12e-3, true); }
  /// For foci that stand.
  void open_still() { board = make(1.5e-3, false); }
  void plan(double hz) {
    const session::Cycle cycle{.plays = session::Plays::pattern, .length = 1, .modulation_hz = hz};
    board->plan({{{100, 1000000, cycle}, clock.now_s(), 1.5e-3}, drive});
  }
  /// As a guard does between drives.
  template <typename Done>
  bool tend_until(const Done& done) {
    return clock.passes_until([&] {
      board->tend();
      return done();
    });
  }
  /// Waits until nothing comes on the line for a tenth of a second.
  bool comes_to_rest() {
    std::uint64_t bytes = 0;
    double since_s = clock.now_s();
    return tend_until([&] {
      if (std::exchange(bytes, machine.bytes()) != machine.bytes()) since_s = clock.now_s();
      return clock.now_s() - since_s > 0.1;
    });
  }
  /// Both of its buffers.
  bool silent() const { return machine.all_silent() && machine.all_silent_behind(); }
  bool becomes_silent() {
    return tend_until([this] { return silent(); });
  }
  bool plays(const array::Drive& wanted) const {
    for (std::size_t t = 0; t < driver::sonicsurface::transducers; ++t) {
      if (!sounds_as(machine, 0, t, wanted[t])) return false;
    }
    return true;
  }
  bool plays_its_drive() {
    return tend_until([this] { return plays(drive); });
  }
  void expect_silent_end() {
    EXPECT_TRUE(board->close());
    board.reset();
    EXPECT_TRUE(clock.passes_until([this] { return silent(); }));
    EXPECT_EQ(machine.violations().count(), 0u) << machine.violations().kept()[0].what;
  }
  /// Turns everything off first.
  void end_silent() {
    board->all_off();
    expect_silent_end();
  }

 private:
  /// Takes the bytes that have had time to come since the last ones.
  void serve() {
    const double now_s = clock.now_s();
    if (!takes) return;
    std::array<std::uint8_t, 4096> bytes{};
    const auto most = static_cast<std::size_t>((now_s - taken_s_) / driver::sonicsurface::seconds_of(1));
    const ssize_t size = most == 0 ? 0 : read(master_.get(), bytes.data(), std::min(most, bytes.size()));
    if (size > 0) {
      termios setting{};
      tcgetattr(master_.get(), &setting);
      machine.set_baud(now_s, cfgetospeed(&setting) == B230400 ? 230400 : 0);
      machine.take(now_s, std::span(bytes).first(static_cast<std::size_t>(size)));
      taken_s_ += driver::sonicsurface::seconds_of(static_cast<std::size_t>(size));
    }
    if (size < static_cast<ssize_t>(most)) taken_s_ = now_s;  // the line has rested
  }

  Descriptor master_, slave_;
  std::string path_;
  double taken_s_ = 0;
};

}  // namespace palpa::test
