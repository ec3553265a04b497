#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

#include "base/log.hpp"

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
  testing::internal::CaptureStderr();
  log::error("e");
  log::warning("w");
  log::info("i");
  log::debug("d");
  return testing::internal::GetCapturedStderr();
}

TEST(Log, EachLevelIncludesThoseBefore) {
  EXPECT_EQ(everything_at(log::Level::quiet), "");
  EXPECT_EQ(everything_at(log::Level::error), "palpa: error: e\n");
  EXPECT_EQ(everything_at(log::Level::warning), "palpa: error: e\npalpa: warning: w\n");
  EXPECT_EQ(everything_at(log::Level::info), "palpa: error: e\npalpa: warning: w\npalpa: info: i\n");
  EXPECT_EQ(everything_at(log::Level::debug), "palpa: error: e\npalpa: warning: w\npalpa: info: i\npalpa: debug: d\n");
}

TEST(Log, AnEventIsOneLineWhateverItHolds) {
  testing::internal::CaptureStderr();
  log::error("a\nb\x1b[2Jc\td");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "palpa: error: a b\\x1b[2Jc d\n");
}

TEST(Log, WarningsAreTheDefault) {
  EXPECT_EQ(log::level(), log::Level::warning);
}

TEST(Log, LevelsAreReadByName) {
  EXPECT_EQ(value_of(log::level_words, "quiet"), log::Level::quiet);
  EXPECT_EQ(value_of(log::level_words, "error"), log::Level::error);
  EXPECT_EQ(value_of(log::level_words, "warning"), log::Level::warning);
  EXPECT_EQ(value_of(log::level_words, "info"), log::Level::info);
  EXPECT_EQ(value_of(log::level_words, "debug"), log::Level::debug);
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

TEST(Log, LinesHaveAtMost500Bytes) {
  testing::internal::CaptureStderr();
  log::error("file " + std::string(5000, '\xff') + " is wrong: give another");
  const std::string line = testing::internal::GetCapturedStderr();
  EXPECT_EQ(line.size(), 501u);
  EXPECT_TRUE(line.starts_with("palpa: error: file \\xff\\xff")) << line;
  EXPECT_TRUE(line.ends_with("\\xff is wrong: give another\n")) << line;
}

}  // namespace
}  // namespace palpa
