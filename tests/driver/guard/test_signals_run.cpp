// Every signal of the system, sent to a loop that plays to an emulated board: the last bytes on its wire.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/sonicsurface/pty.hpp"
#include "support/instrumented.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"

namespace palpa::test {
namespace {

using namespace std::chrono_literals;

/// A board that is always present and sounds from power-up.
class LiveBoard {
 public:
  LiveBoard() : thread_([this] { pty_.serve(boards_, stop_, lock_); }) {}
  ~LiveBoard() {
    stop_ = true;
    thread_.join();
  }
  LiveBoard(const LiveBoard&) = delete;
  LiveBoard& operator=(const LiveBoard&) = delete;
  const std::string& path() const { return path_; }

  bool becomes(const std::function<bool(const driver::sonicsurface::EmulatedBoards&)>& wanted) {
    for (int i = 0; i < 60000; ++i, std::this_thread::sleep_for(1ms)) {
      const std::lock_guard held(lock_);
      if (wanted(boards_)) return true;
    }
    return false;
  }
  /// Whether a program's pattern sounds, between its pauses. A program first silences both buffers, which takes two
  /// swaps. That state may be too short to be seen.
  bool sounds() {
    return becomes([](const auto& boards) { return boards.swaps() > 2 && !boards.all_silent(); });
  }
  /// Whether both of its buffers fall silent.
  bool falls_silent() {
    return becomes([](const auto& boards) { return boards.all_silent() && boards.all_silent_behind(); });
  }

 private:
  driver::sonicsurface::Pty pty_;
  std::string path_ = pty_.path();
  driver::sonicsurface::EmulatedBoards boards_{1, false};
  std::atomic<bool> stop_{false};
  std::mutex lock_;
  std::thread thread_;
};

enum class Means {
  end,      ///< the loop ends by itself
  death,    ///< the system ends it; its guard silences the board
  stop,     ///< the system stops it; its guard silences the board
  nothing,  ///< it continues to sound
  either    ///< death or nothing: a signal of the C library, which no program can catch; the library may have caught it
            ///< itself
};

Means meaning_of(int signal) {
  switch (signal) {
    case SIGKILL:
    case SIGSEGV:
    case SIGABRT:
    case SIGBUS:
    case SIGFPE:
    case SIGILL:
    case SIGTRAP:
    case SIGSYS:
      return Means::death;
    case 32:
    case 33:
      return Means::either;
    case SIGSTOP:
      return Means::stop;
    case SIGCHLD:
    case SIGCONT:
    case SIGURG:
    case SIGWINCH:
    case SIGTTIN:
    case SIGTTOU:
      return Means::nothing;
    default:
      return Means::end;
  }
}

/// Sends the signal to a loop that sounds.
void expect_silence(LiveBoard& board, const std::vector<std::string>& command, int signal) {
  SCOPED_TRACE("signal " + std::to_string(signal) + " (" + strsignal(signal) + "), palpa " + command.front());
  LiveOptions options;
  options.command = command.front().c_str();
  LiveRun loop({command.begin() + 1, command.end()}, options);
  ASSERT_TRUE(board.sounds());
  loop.signal(signal);
  Means means = meaning_of(signal);
  if (means == Means::either) {
    const LiveRun::End end = loop.wait(0.1);
    if (end.ended) {
      EXPECT_EQ(end.by_signal, signal);
      EXPECT_TRUE(board.falls_silent());
      return;
    }
    means = Means::nothing;
  }
  if (means == Means::nothing) {
    EXPECT_FALSE(loop.wait(0.02).ended);
    EXPECT_TRUE(board.sounds());
    loop.signal(SIGTERM);
  }
  if (means == Means::stop) {
    EXPECT_TRUE(board.falls_silent());
    loop.signal(SIGKILL);
  }
  EXPECT_TRUE(board.falls_silent()) << "whatever came";
  const LiveRun::End end = loop.wait(10);
  ASSERT_TRUE(end.ended);
  if (means == Means::death || means == Means::stop) {
    // Sanitizers report a fault of memory or arithmetic, and end the program by an exit code.
    const bool reported = instrumented() && end.by_signal == 0 && end.exit_code != 0;
    EXPECT_TRUE(end.by_signal == (means == Means::stop ? SIGKILL : signal) || reported) << end.by_signal;
  } else {
    EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 1) << "1: a busy machine did not get it done within a second";
  }
  EXPECT_TRUE(board.falls_silent());
}

std::vector<std::string> sweep(const LiveBoard& board) {
  return {"link", "test", "--layout", "sonicsurface", "--link", "sonicsurface:" + board.path(), "--each", "100s"};
}

TEST(SignalsRun, EverySignalOfTheSystemLeavesABoardSilent) {
  PALPA_TERMINAL_OR_SKIP();
  std::atomic<int> next{1};
  const auto one_after_the_other = [&] {
    LiveBoard board;
    for (int signal = next++; signal < NSIG; signal = next++)
      expect_silence(board, sweep(board), signal);
  };
  side_by_side(std::vector<std::function<void()>>(4, one_after_the_other));
}

TEST(SignalsRun, ThoseThatAWriteRaisesEndARunToo) {
  PALPA_TERMINAL_OR_SKIP();
  const auto ends = [](int signal) {
    LiveBoard board;
    expect_silence(board,
                   with({"run", "--scene", source_file("assets/cube.glb").string(), "--backend", "cpu", "--source",
                         "synthetic", "--hold", "500ms", "--layout", "sonicsurface", "--link",
                         "sonicsurface:" + board.path(), "--method", "single-focus"},
                        small_frames()),
                   signal);
  };
  side_by_side(3, std::vector{SIGXFSZ, SIGPIPE, SIGTERM}, ends);
}

TEST(SignalsRun, SignalsThatItsParentIgnoresStayIgnored) {
  PALPA_TERMINAL_OR_SKIP();
  const auto goes_on = [](int signal) {
    SCOPED_TRACE(strsignal(signal));
    LiveBoard board;
    LiveOptions options;
    options.program = "/bin/sh";
    LiveRun loop(with({"-c", R"(trap '' XFSZ PIPE HUP; exec "$0" "$@")", palpa_binary()}, sweep(board)), options);
    ASSERT_TRUE(board.sounds());
    loop.signal(signal);
    EXPECT_FALSE(loop.wait(0.05).ended);
    EXPECT_TRUE(board.sounds());
    loop.signal(SIGTERM);
    EXPECT_TRUE(loop.wait(10).ended);
    EXPECT_TRUE(board.falls_silent());
  };
  side_by_side(3, std::vector{SIGXFSZ, SIGPIPE, SIGHUP}, goes_on);
}

}  // namespace
}  // namespace palpa::test
