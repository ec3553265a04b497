// Every signal of the system, sent to a loop that plays to an emulated board: the last bytes on its wire.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/autd3/autd3_rig.hpp"
#include "driver/rig_parts.hpp"
#include "driver/sonicsurface/sonicsurface_rig.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"

namespace palpa::test {
namespace {

enum class Means {
  end,      ///< the loop ends by itself
  death,    ///< the system ends it; its guard silences the board
  stop,     ///< the system stops it; its guard silences the board
  nothing,  ///< it continues to sound
  either    ///< death or nothing: a signal of the C library, which no program can catch; the library may have caught it
            ///< itself
};

Means meaning_of(int signal) {
  const auto is_one_of = [signal](std::initializer_list<int> signals) {
    return std::find(signals.begin(), signals.end(), signal) != signals.end();
  };
  if (is_one_of({SIGKILL, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS})) return Means::death;
  if (is_one_of({SIGCHLD, SIGCONT, SIGURG, SIGWINCH, SIGTTIN, SIGTTOU})) return Means::nothing;
  if (is_one_of({32, 33})) return Means::either;
  return signal == SIGSTOP ? Means::stop : Means::end;
}

/// Whether a person or a program asks palpa to end with it. The others end it as failed, such as SIGXCPU.
bool asks_to_end(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT || signal == SIGTSTP;
}

/// Sends the signal to a loop that sounds.
void expect_silence(SonicSurfaceLine& board, const std::vector<std::string>& command, int signal) {
  SCOPED_TRACE("signal " + std::to_string(signal) + " (" + strsignal(signal) + "), palpa " + command.front());
  const std::string said = scratch_folder("signal-" + std::to_string(signal)) / "stderr";
  const Unread err = Unread::file(said);
  LiveOptions options{.err = &err};
  options.command = command.front().c_str();
  LiveRun loop({command.begin() + 1, command.end()}, options);
  ASSERT_TRUE(board.sounds()) << read_text(said);
  loop.signal(signal);
  const Means means = meaning_of(signal);
  if (means == Means::either && !loop.wait(0.1).ended) loop.signal(SIGTERM);
  if (means == Means::nothing) {
    EXPECT_FALSE(loop.wait(0.02).ended);
    EXPECT_TRUE(board.sounds());
    loop.signal(SIGTERM);
  }
  if (means == Means::stop) {
    EXPECT_TRUE(board.falls_silent());
    loop.signal(SIGCONT);
    EXPECT_TRUE(board.sounds()) << "it goes on: " << read_text(said);
    loop.signal(SIGKILL);
  }
  EXPECT_TRUE(board.falls_silent()) << "whatever came";
  const LiveRun::End end = loop.wait(60);
  ASSERT_TRUE(end.ended);
  if (means == Means::death || means == Means::stop) {
    // Sanitizers report a fault of memory or arithmetic, and end the program by an exit code.
    const bool reported = instrumented() && end.by_signal == 0 && end.exit_code != 0;
    EXPECT_TRUE(end.by_signal == (means == Means::stop ? SIGKILL : signal) || reported) << end.by_signal;
  } else if (means != Means::either || end.by_signal != signal) {
    EXPECT_TRUE(end.exit_code == 0 || end.exit_code == 1) << "1: a busy machine did not get it done within a second";
    if (means == Means::end && !asks_to_end(signal)) {
      EXPECT_EQ(end.exit_code, 1) << "nobody has asked for it";
      const std::string told = read_text(said);
      EXPECT_TRUE(told.find("cut short by signal " + std::to_string(signal)) != std::string::npos ||
                  told.find("ended without finishing") != std::string::npos)
          << told;
    }
  }
  EXPECT_TRUE(board.falls_silent());
}

std::vector<std::string> sweep(const SonicSurfaceLine& board) {
  return {"link", "test", "--layout", "sonicsurface", "--link", "sonicsurface:" + board.path(), "--each", "100s"};
}

TEST(SignalsRun, EverySignalOfTheSystemLeavesABoardSilent) {
  PALPA_TERMINAL_OR_SKIP();
  std::atomic<int> next{1};
  const auto one_after_the_other = [&] {
    SonicSurfaceLine board;
    for (int signal = next++; signal < NSIG; signal = next++)
      expect_silence(board, sweep(board), signal);
  };
  side_by_side(std::vector<std::function<void()>>(4, one_after_the_other));
}

TEST(SignalsRun, Autd3UnitsFallSilentWithTheirLoop) {
  driver::autd3::EmulatedServer server(16);
  Autd3Serving serving(server);
  const auto silent = [&] { return server.silent(driver::autd3::device_time_s()); };
  const auto sounds = [&] { return !silent(); };
  LiveOptions options;
  options.command = "link";
  LiveRun loop({"test", "--layout", "paper", "--link", "autd3:" + serving.address(), "--each", "100s"}, options);
  ASSERT_TRUE(becomes(serving.lock, sounds));
  loop.signal(SIGSTOP);
  EXPECT_TRUE(becomes(serving.lock, silent)) << "stopped";
  loop.signal(SIGCONT);
  EXPECT_TRUE(becomes(serving.lock, sounds)) << "and goes on";
  loop.signal(SIGKILL);
  EXPECT_TRUE(becomes(serving.lock, [&] { return silent() && !server.connected(); })) << "it has also said goodbye";
  EXPECT_EQ(server.violation_count(), 0u) << server.violations()[0].what;
}

TEST(SignalsRun, ThoseThatAWriteRaisesEndARunToo) {
  PALPA_TERMINAL_OR_SKIP();
  const auto ends = [](int signal) {
    SonicSurfaceLine board;
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
    SonicSurfaceLine board;
    LiveOptions options;
    options.program = "/bin/sh";
    LiveRun loop(with({"-c", R"(trap '' XFSZ PIPE HUP; exec "$0" "$@")", palpa_binary()}, sweep(board)), options);
    ASSERT_TRUE(board.sounds());
    loop.signal(signal);
    EXPECT_FALSE(loop.wait(0.05).ended);
    EXPECT_TRUE(board.sounds());
    loop.signal(SIGTERM);
    EXPECT_TRUE(loop.wait(60).ended);
    EXPECT_TRUE(board.falls_silent());
  };
  side_by_side(3, std::vector{SIGXFSZ, SIGPIPE, SIGHUP}, goes_on);
}

}  // namespace
}  // namespace palpa::test
