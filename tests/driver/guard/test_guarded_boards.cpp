// Boards held by the guard that palpa installs, on recorded lines: however the loop ends, the last bytes on the wire
// are the board's own silence.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/log.hpp"
#include "driver/autd3/board.hpp"
#include "driver/autd3/listen.hpp"
#include "driver/guard/board_link.hpp"
#include "driver/sonicsurface/board.hpp"
#include "driver/sonicsurface/pty.hpp"
#include "forked_loop.hpp"
#include "support/pseudo_terminal.hpp"

namespace palpa::driver {
namespace {

using namespace std::chrono_literals;

/// What a loop does until it ends: sends a plan as often as a camera has frames, and sends its drives.
std::function<void()> plays(const BoardKind& kind, const std::string& argument, const std::string& layout_name,
                            bool foci_move) {
  return [=] {
    const array::Layout layout = array::load_layout(layout_name);
    const std::vector<std::string> names;
    const auto guard = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpa-guard";
    const auto link =
        board_link(kind, guard.string()).open(argument, {layout, names, foci_move ? 12e-3 : 1.5e-3, foci_move});
    const std::size_t count = layout.transducers.size();
    const std::uint32_t parts = foci_move ? 5 : 1;
    array::Drive drives(parts * count);
    for (std::size_t i = 0; i < drives.size(); ++i)
      drives[i] = {1.0f, static_cast<float>(i % 50) / 50};
    array::Schedule schedule;
    schedule.slot_s = foci_move ? 12e-3 : 1.5e-3;
    schedule.add_voice().foci = {Vec3(0)};
    for (std::uint64_t s = 0;; ++s, std::this_thread::sleep_for(std::chrono::duration<double>(schedule.slot_s))) {
      if (s % 8 == 0) {
        link->plan({.schedule = schedule,
                    .slots = {s, s + 60, {.length = parts, .modulation_hz = foci_move ? 0.0 : 200.0}},
                    .drives = drives});
      }
      link->send(s, std::span(drives).subspan(s % parts * count, count));
    }
  };
}

/// Serves on a separate thread; queries take the lock.
class Serving {
 public:
  explicit Serving(const std::function<void(const std::atomic<bool>&, std::mutex&)>& serve)
      : thread_([this, serve] { serve(stop_, lock_); }) {}
  ~Serving() {
    stop_ = true;
    thread_.join();
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;
  bool becomes(const std::function<bool()>& true_now) {
    for (int i = 0; i < 60000; ++i, std::this_thread::sleep_for(1ms)) {
      const std::lock_guard held(lock_);
      if (true_now()) return true;
    }
    return false;
  }

 private:
  std::atomic<bool> stop_{false};
  std::mutex lock_;
  std::thread thread_;
};

/// Through a stop and a continuation until the loop's end.
void expect_silence_after(test::ForkedLoop& loop, Serving& serving, const std::function<bool()>& silent) {
  const auto sounds = [&] { return !silent(); };
  ASSERT_TRUE(serving.becomes(sounds));
  loop.signal(SIGSTOP);
  EXPECT_TRUE(serving.becomes(silent)) << "stopped";
  std::this_thread::sleep_for(50ms);
  EXPECT_TRUE(serving.becomes(silent));
  loop.signal(SIGCONT);
  EXPECT_TRUE(serving.becomes(sounds)) << "and goes on";
  std::this_thread::sleep_for(30ms);
  loop.end(SIGKILL);
  EXPECT_TRUE(serving.becomes(silent)) << "killed";
}

TEST(GuardedBoards, AGuardsMemoryStaysInMemory) {
  if (mlockall(MCL_CURRENT) != 0) GTEST_SKIP() << "skipped: this machine allows no locked memory (ulimit -l)";
  munlockall();
  autd3::EmulatedServer server(1);
  autd3::Listener listener(0);
  const Serving serving([&](const std::atomic<bool>& stop, std::mutex& lock) { listener.serve(server, stop, lock); });
  const array::Layout layout = array::load_layout("autd3");
  const std::vector<std::string> names;
  const auto guard = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpa-guard";
  const auto link = board_link(autd3::board_kind(), guard.string()).open(listener.address(), {layout, names, 1.5e-3});
  pid_t child = 0;
  std::ifstream("/proc/self/task/" + std::to_string(getpid()) + "/children") >> child;
  std::string locked;
  for (int i = 0; i < 1000 && (locked.empty() || locked.ends_with(" 0 kB")); ++i, std::this_thread::sleep_for(1ms)) {
    std::ifstream status("/proc/" + std::to_string(child) + "/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("VmLck:")) locked = line;
  }
#if !defined(PALPA_ADDRESS_SANITIZER) && !defined(PALPA_THREAD_SANITIZER)
  EXPECT_FALSE(locked.ends_with(" 0 kB")) << locked;
#endif
  link->finish();
}

TEST(GuardedBoards, Autd3UnitsFallSilentWithTheirLoop) {
  autd3::EmulatedServer server(16);
  autd3::Listener listener(0);
  test::ForkedLoop loop(plays(autd3::board_kind(), listener.address(), "paper", true));
  Serving serving([&](const auto& stop, std::mutex& lock) { listener.serve(server, stop, lock); });
  expect_silence_after(loop, serving, [&] { return server.silent(autd3::device_time_s()); });
  // It has also said goodbye.
  EXPECT_TRUE(serving.becomes([&] { return !server.connected(); }));
  EXPECT_EQ(server.violation_count(), 0u) << server.violations()[0].what;
}

TEST(GuardedBoards, SonicSurfaceFallsSilentWithItsLoop) {
  PALPA_TERMINAL_OR_SKIP();
  sonicsurface::EmulatedBoards boards(1, false);
  sonicsurface::Pty pty;
  test::ForkedLoop loop(plays(sonicsurface::board_kind(), pty.path(), "sonicsurface", false));
  Serving serving([&](const auto& stop, std::mutex& lock) { pty.serve(boards, stop, lock); });
  // The modulation has pauses, so silence also requires that nothing waits behind.
  const auto silent = [&] { return boards.all_silent() && boards.all_silent_behind(); };
  // It sounds when it is switched on. A loop first silences both buffers, which takes two swaps.
  ASSERT_TRUE(serving.becomes([&] { return boards.swaps() > 2; }));
  expect_silence_after(loop, serving, silent);
  EXPECT_EQ(boards.violations().count(), 0u) << boards.violations().kept()[0].what;
}

}  // namespace
}  // namespace palpa::driver
