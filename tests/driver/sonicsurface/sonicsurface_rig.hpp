// Emulated SonicSurface boards on a pseudo terminal, and a board on it as its guard has it.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <thread>
#include <utility>

#include "base/system/now.hpp"
#include "driver/rig_parts.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/emulated/boards.hpp"
#include "driver/sonicsurface/emulated/pty.hpp"
#include "driver/sonicsurface/wire.hpp"

namespace palpa::test {

/// One board on a serial line, which sounds from power-up.
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

/// A line, and a board on it as its guard has it.
struct SonicSurfaceRig : SonicSurfaceLine {
  array::Layout layout = array::load_layout("sonicsurface");
  std::string argument = path(), files;
  KeptNotes notes;
  std::unique_ptr<driver::Board> board;
  array::Drive drive = some_drive(1), silence = array::Drive(driver::sonicsurface::transducers, {0.0f, 0.0f});

  std::unique_ptr<driver::Board> make(double slot_s, bool foci_move) {
    return driver::sonicsurface::board_kind().open({argument, files, layout, slot_s, foci_move}, notes);
  }
  /// For foci that move, slow enough for a frame each.
  void open() { board = make(12e-3, true); }
  /// For foci that stand.
  void open_still() { board = make(1.5e-3, false); }
  void plan(double hz) {
    const session::Cycle cycle{.plays = session::Plays::pattern, .length = 1, .modulation_hz = hz};
    board->plan({{{100, 1000000, cycle}, monotonic_s(), 1.5e-3}, drive});
  }
  /// Does what a guard does between drives: waits for what the board watches, 5 ms at most.
  template <typename Done>
  bool tend_until(const Done& done) {
    return begins([&] {
      std::array<pollfd, 2> fds{};
      const auto watched = board->watched();
      std::copy(watched.begin(), watched.end(), fds.begin());
      poll(fds.data(), watched.size(), 5);
      board->tend();
      const std::lock_guard held(lock);
      return done();
    });
  }
  /// Waits until nothing comes on the line for a tenth of a second.
  bool comes_to_rest() {
    std::uint64_t bytes = 0;
    double since_s = monotonic_s();
    return tend_until([&] {
      if (std::exchange(bytes, machine.bytes()) != machine.bytes()) since_s = monotonic_s();
      return monotonic_s() - since_s > 0.1;
    });
  }
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
    EXPECT_TRUE(falls_silent());
    const std::lock_guard held(lock);
    EXPECT_EQ(machine.violations().count(), 0u) << machine.violations().kept()[0].what;
  }
  /// Turns everything off first.
  void end_silent() {
    board->all_off();
    expect_silent_end();
  }
};

}  // namespace palpa::test
