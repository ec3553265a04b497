// How a program ends is decided once, whatever several threads find.
#include "setup/process/ending.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "setup/process/interrupt.hpp"
#include "setup/process/program.hpp"

namespace palpa::setup {
namespace {

TEST(Ending, IsDecidedByTheFirstThread) {
  for (int round = 0; round < 50; ++round) {
    begin_ending();
    EXPECT_EQ(ending(), Exit::ok);
    std::array<std::atomic<bool>, 5> decided{};
    std::vector<std::thread> threads;
    for (int code = 0; code < 5; ++code)
      threads.emplace_back(
          [&, code] { decided[static_cast<std::size_t>(code)] = decide_ending(static_cast<Exit>(code)); });
    for (std::thread& thread : threads)
      thread.join();
    int count = 0;
    for (std::size_t code = 0; code < 5; ++code) {
      count += decided[code] ? 1 : 0;
      if (decided[code]) {
        EXPECT_EQ(static_cast<std::size_t>(ending()), code);
      }
    }
    EXPECT_EQ(count, 1);
  }
}

TEST(Ending, AProgramThatEndsTooLateIsNoSuccessAndHasOneLine) {
  const auto run = [](const auto& body) {
    testing::internal::CaptureStderr();
    const int code = run_program(body);
    return std::pair(code, testing::internal::GetCapturedStderr());
  };
  // The watch for signals has printed its line and decided.
  EXPECT_EQ(run([] { decide_ending(Exit::failed); }), std::pair(1, std::string()));
  EXPECT_EQ(run([] {
              decide_ending(Exit::failed);
              throw bad_usage("a second line");
            }),
            std::pair(1, std::string()));
  EXPECT_EQ(run([] { throw bad_usage("the only line"); }), std::pair(2, std::string("palpa: error: the only line\n")));
  EXPECT_FALSE(decide_ending(Exit::failed)) << "the watch comes too late";
  EXPECT_EQ(run([] {}), std::pair(0, std::string()));
}

/// A program that was started with nohup, or in the background of a script.
TEST(Interrupt, LeavesSignalsAloneThatTheParentIgnores) {
  using Handler = void (*)(int);
  const auto handler_of = [](int signal) {
    struct sigaction now {};
    sigaction(signal, nullptr, &now);
    return now.sa_handler;
  };
  const std::vector<int> signals{SIGINT,  SIGTERM, SIGHUP,  SIGQUIT, SIGTSTP, SIGUSR1,
                                 SIGUSR2, SIGPIPE, SIGXFSZ, SIGTTOU, SIGTTIN, SIGRTMAX};
  for (const Handler before : {SIG_IGN, SIG_DFL}) {
    std::vector<Handler> own;
    for (const int signal : signals)
      own.push_back(std::signal(signal, before));
    {
      const Interrupt interrupt("late");
      for (const int signal : signals) {
        const bool ignored = signal == SIGTTOU || signal == SIGTTIN || before == SIG_IGN;
        EXPECT_EQ(handler_of(signal) == SIG_IGN, ignored) << strsignal(signal);
        EXPECT_NE(handler_of(signal), SIG_DFL) << strsignal(signal);
      }
      if (before == SIG_IGN && handler_of(SIGHUP) == SIG_IGN) raise(SIGHUP);
      EXPECT_FALSE(Interrupt::signalled());
      EXPECT_FALSE(Interrupt::flag());
    }
    for (std::size_t i = 0; i < signals.size(); ++i) {
      EXPECT_EQ(handler_of(signals[i]), before) << strsignal(signals[i]);
      std::signal(signals[i], own[i]);
    }
  }
}

/// The watch for signals ends the process as soon as the line is out, and after its patience where nobody reads it.
TEST(Ending, ItsLineIsOutBeforeTheProcessEnds) {
  constexpr std::chrono::seconds long_enough{100};
  const auto in_time = [](std::chrono::milliseconds most) {
    const auto begin = std::chrono::steady_clock::now();
    wait_for_line(most);
    return std::chrono::steady_clock::now() - begin < most;
  };
  // The log has a patience of 0.1 s with its own thread, which a busy machine may let wait for longer.
  const auto tells_in_time = [](const std::string& line) {
    const auto begin = std::chrono::steady_clock::now();
    tell_ending(line);
    return std::chrono::steady_clock::now() - begin < std::chrono::milliseconds(80);
  };
  int lines = 0;
  for (int round = 0; round < 20; ++round) {
    begin_ending();
    EXPECT_FALSE(in_time(std::chrono::milliseconds(1))) << "nothing is decided";
    EXPECT_TRUE(decide_ending(Exit::failed));
    EXPECT_FALSE(in_time(std::chrono::milliseconds(1))) << "it is not written";
    testing::internal::CaptureStderr();
    const log::Relay relay;
    bool patient = false;
    std::thread teller([&] { patient = tells_in_time("the only line"); });
    EXPECT_TRUE(in_time(long_enough));
    const std::string told = testing::internal::GetCapturedStderr();
    EXPECT_TRUE(in_time(long_enough)) << "again";
    teller.join();
    if (!patient) continue;
    EXPECT_EQ(told, "palpa: error: the only line\n");
    ++lines;
  }
  EXPECT_GT(lines, 0);
  begin_ending();
  decide_ending(Exit::ok);
  EXPECT_TRUE(in_time(long_enough)) << "a success has no line";
}

}  // namespace
}  // namespace palpa::setup
