#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/log.hpp"
#include "support/begins.hpp"
#include "support/captured.hpp"

namespace palpa {
namespace {

/// Sets a level for one test.
class AtLevel {
 public:
  explicit AtLevel(log::Level level) : before_(log::level()) { log::set_level(level); }
  ~AtLevel() { log::set_level(before_); }
  AtLevel(const AtLevel&) = delete;
  AtLevel& operator=(const AtLevel&) = delete;

 private:
  log::Level before_;
};

std::string everything_at(log::Level level) {
  const AtLevel at(level);
  return test::stderr_of([] {
    log::error("e");
    log::warning("w");
    log::info("i");
    log::debug("d");
  });
}

TEST(Log, EachLevelIncludesThoseBefore) {
  EXPECT_EQ(everything_at(log::Level::quiet), "");
  EXPECT_EQ(everything_at(log::Level::error), "palpa: error: e\n");
  EXPECT_EQ(everything_at(log::Level::warning), "palpa: error: e\npalpa: warning: w\n");
  EXPECT_EQ(everything_at(log::Level::info), "palpa: error: e\npalpa: warning: w\npalpa: info: i\n");
  EXPECT_EQ(everything_at(log::Level::debug), "palpa: error: e\npalpa: warning: w\npalpa: info: i\npalpa: debug: d\n");
}

TEST(Log, AnEventIsOneLineWhateverItHolds) {
  EXPECT_EQ(test::stderr_of([] { log::error("a\nb\x1b[2Jc\td"); }), "palpa: error: a b\\x1b[2Jc d\n");
}

TEST(Log, WarningsAreTheDefault) {
  EXPECT_EQ(log::level(), log::Level::warning);
}

TEST(Log, LevelsAreReadByName) {
  using enum log::Level;
  for (const auto& [word, level] :
       {std::pair("quiet", quiet), {"error", error}, {"warning", warning}, {"info", info}, {"debug", debug}})
    EXPECT_EQ(value_of(log::level_words, word), level) << word;
  for (const char* other : {"", "Debug", "warn", "debug ", "trace"})
    EXPECT_FALSE(value_of(log::level_words, other)) << other;
}

TEST(Log, LinesOfSeveralThreadsStayWhole) {
  const AtLevel at(log::Level::info);
  const std::string line(200, 'x');
  testing::internal::CaptureStderr();
  {
    std::vector<std::jthread> threads;
    threads.reserve(4);
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 200; ++i)
          log::info(line);
      });
    }
  }
  std::string expected;
  for (int i = 0; i < 800; ++i)
    expected += "palpa: info: " + line + "\n";
  EXPECT_EQ(testing::internal::GetCapturedStderr(), expected);
}

TEST(Log, HeldWarningsAreWrittenOnReleaseAndForgottenOnDrop) {
  log::set_level(log::Level::warning);
  testing::internal::CaptureStderr();
  log::hold_warnings();
  log::warning("first");
  log::warning("second");
  log::error("not held");
  log::release_warnings();
  log::warning("third");
  log::hold_warnings();
  log::warning("forgotten");
  log::drop_warnings();
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "palpa: error: not held\npalpa: warning: first\npalpa: warning: second\npalpa: warning: third\n");
}

TEST(Log, TheSameWarningIsToldOnceWithACount) {
  log::set_level(log::Level::warning);
  testing::internal::CaptureStderr();
  log::hold_warnings();
  for (int i = 0; i < 41; ++i)
    log::warning("often");
  log::warning("once");
  log::release_warnings();
  for (int i = 0; i < 3; ++i)
    log::warning("later");
  log::warning("once");
  log::release_warnings();
  log::release_warnings();
  log::drop_warnings();
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "palpa: warning: often (41 times)\npalpa: warning: once\npalpa: warning: later\n"
            "palpa: warning: once (2 times)\npalpa: warning: later (3 times)\n");
}

TEST(Log, WarningsBeyondTheLimitAreCounted) {
  log::set_level(log::Level::warning);
  testing::internal::CaptureStderr();
  log::hold_warnings();
  for (int i = 0; i < 1003; ++i)
    log::warning(std::to_string(i));
  log::release_warnings();
  log::drop_warnings();
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1001);
  EXPECT_TRUE(told.ends_with("palpa: warning: 999\npalpa: warning: and 3 more warnings\n"));
}

TEST(Log, LinesHaveAtMost500Bytes) {
  const std::string line =
      test::stderr_of([] { log::error("file " + std::string(5000, '\xff') + " is wrong: give another"); });
  EXPECT_EQ(line.size(), 501u);
  EXPECT_TRUE(line.starts_with("palpa: error: file \\xff\\xff")) << line;
  EXPECT_TRUE(line.ends_with("\\xff is wrong: give another\n")) << line;
}

/// stderr is a pipe that takes nothing more until it is read.
class FullStderr {
 public:
  FullStderr() : before_(dup(STDERR_FILENO)) {
    EXPECT_EQ(pipe(ends_.data()), 0);
    fcntl(ends_[1], F_SETFL, O_NONBLOCK);
    while (write(ends_[1], "................", 16) > 0) {
    }
    fcntl(ends_[1], F_SETFL, 0);
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    dup2(ends_[1], STDERR_FILENO);
  }
  ~FullStderr() {
    dup2(before_, STDERR_FILENO);
    for (const int end : {ends_[0], ends_[1], before_})
      close(end);
  }
  FullStderr(const FullStderr&) = delete;
  FullStderr& operator=(const FullStderr&) = delete;

  /// Reads until that many lines have come, or the time of begins() is up.
  std::string read_lines(std::uint64_t lines) const {
    std::string text;
    std::array<char, 4096> block;
    test::begins([&] {
      for (ssize_t got; (got = read(ends_[0], block.data(), block.size())) > 0;)
        text.append(block.data(), static_cast<std::size_t>(got));
      return static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n')) >= lines;
    });
    return text;
  }

 private:
  std::array<int, 2> ends_{};
  int before_;
};

TEST(LogRelay, AReaderThatDoesNotReadDelaysNobody) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  {
    const FullStderr full;
    const log::Relay relay;
    for (int i = 0; i < 5000; ++i)  // a third of a megabyte; 64 KiB wait
      log::warning("line " + std::to_string(i) + " of a great many that nobody reads");
    log::draw("\rbar");
    EXPECT_LT(Clock::now() - begin, std::chrono::minutes(1)) << "a reader that never comes is not waited for";
    const std::uint64_t left_out = log::Relay::left_out();
    EXPECT_GT(left_out, 3000u);
    // A reader that comes back gets the beginning, and at the gap the number of missing lines.
    std::string text = full.read_lines(5000 - left_out);
    const auto lines = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\n'));
    EXPECT_EQ(lines + left_out, 5000u);
    EXPECT_NE(text.find("palpa: warning: line 0 of"), std::string::npos);
    EXPECT_EQ(text.find("bar"), std::string::npos) << "what a terminal shows for a moment is not kept";
    log::error("and now?");
    text = full.read_lines(2);
    EXPECT_EQ(text, "palpa: warning: " + std::to_string(left_out) +
                        " lines were left out here: nobody read them\npalpa: error: and now?\n");
    EXPECT_EQ(log::Relay::left_out(), 0u);
  }
}

TEST(LogRelay, EndsSoonWithoutAReader) {
  const auto begin = std::chrono::steady_clock::now();
  {
    const FullStderr full;
    const log::Relay relay, another;
    for (int i = 0; i < 5000; ++i)
      log::warning("line " + std::to_string(i) + " of a great many that nobody reads");
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::minutes(1));
  // The lines that were left out are reported to a later reader.
  const std::uint64_t left_out = log::Relay::left_out();
  EXPECT_EQ(left_out, 5000u) << "those that waited to the end are counted, too";
  EXPECT_EQ(test::stderr_of([] { log::error("the end"); }),
            "palpa: warning: " + std::to_string(left_out) +
                " lines were left out here: nobody read them\npalpa: error: the end\n");
}

TEST(LogRelay, WritesWhatItIsGivenInOrder) {
  const std::string told = test::stderr_of([] {
    {
      const log::Relay relay;
      log::warning("a");
      log::error("b");
    }
    log::error("c");
  });
  EXPECT_EQ(told, "palpa: warning: a\npalpa: error: b\npalpa: error: c\n");
}

}  // namespace
}  // namespace palpa
