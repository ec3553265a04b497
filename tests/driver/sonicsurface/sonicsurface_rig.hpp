// A SonicSurface on a pseudo terminal, as its guard has it.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "driver/guard/channel.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/machine.hpp"
#include "driver/sonicsurface/pty.hpp"
#include "driver/sonicsurface/wire.hpp"
#include "support/begins.hpp"

namespace palpa::test {

inline array::Drive some_drive(std::size_t boards) {
  array::Drive drive(boards * driver::sonicsurface::transducers);
  for (std::size_t t = 0; t < drive.size(); ++t)
    drive[t] = {1.0f,
                static_cast<float>(static_cast<double>(t * 37 % 128) / 128 * 2 * std::numbers::pi - std::numbers::pi)};
  drive[5].amplitude = 0;
  return drive;
}

inline int expected_phase(const array::TransducerDrive& t, int steps) {
  if (t.amplitude == 0) return driver::sonicsurface::EmulatedBoards::silent;
  const double turns = t.phase / (2 * std::numbers::pi);
  return static_cast<int>(std::floor(steps * (turns - std::floor(turns)) + 0.5)) % steps * (32 / steps);
}

class SonicSurfaceNotes final : public driver::BoardNotes {
 public:
  void warning(std::string_view line) noexcept override { warnings.emplace_back(line); }
  void info(std::string_view) noexcept override {}
  std::vector<std::string> warnings;
};

/// A board on a pseudo terminal, as its guard has it.
struct SonicSurfaceRig {
  array::Layout layout = array::load_layout("sonicsurface");
  driver::sonicsurface::EmulatedBoards machine{1, false};
  driver::sonicsurface::Pty pty;
  std::string argument = pty.path(), files;
  SonicSurfaceNotes notes;
  std::mutex lock;
  std::atomic<bool> stop{false};
  std::thread thread{[this] { pty.serve(machine, stop, lock); }};
  std::unique_ptr<driver::Board> board;
  array::Drive drive = some_drive(1), silence = array::Drive(driver::sonicsurface::transducers, {0.0f, 0.0f});

  ~SonicSurfaceRig() {
    stop = true;
    thread.join();
  }
  std::unique_ptr<driver::Board> make(double slot_s, bool foci_move) {
    return driver::sonicsurface::board_kind().open({argument, files, layout, slot_s, foci_move}, notes);
  }
  void plan(double hz) {
    const session::Cycle cycle{.length = 1, .modulation_hz = hz};
    board->plan({{{100, 1000000, cycle}, driver::monotonic_s(), 1.5e-3}, drive});
  }
  /// Does what a guard does between drives: waits for what the board watches, 5 ms at most.
  template <typename Done>
  bool tend_until(const Done& done, std::chrono::milliseconds at_most = std::chrono::minutes(1)) {
    for (const auto end = std::chrono::steady_clock::now() + at_most; std::chrono::steady_clock::now() < end;) {
      std::array<pollfd, 2> fds{};
      const auto watched = board->watched();
      std::copy(watched.begin(), watched.end(), fds.begin());
      poll(fds.data(), watched.size(), 5);
      board->tend();
      const std::lock_guard held(lock);
      if (done()) return true;
    }
    return false;
  }
  bool plays(const array::Drive& wanted) const {
    for (std::size_t t = 0; t < driver::sonicsurface::transducers; ++t) {
      if (machine.sounding(0, t) != expected_phase(wanted[t], 32)) return false;
    }
    return true;
  }
  void expect_silent_end() {
    EXPECT_TRUE(board->close());
    board.reset();
    const auto silent = [&] {
      const std::lock_guard held(lock);
      return machine.all_silent() && machine.all_silent_behind();
    };
    EXPECT_TRUE(begins(silent));
    const std::lock_guard held(lock);
    EXPECT_EQ(machine.violations().count(), 0u) << machine.violations().kept()[0].what;
  }
};

}  // namespace palpa::test
