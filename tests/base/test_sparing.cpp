// Warnings that are written once each, and not too many at a time.
#include <gtest/gtest.h>

#include <string>

#include "base/sparing.hpp"

namespace palpa {
namespace {

TEST(Sparing, WritesEachTextOnceAndThreeInASecond) {
  using std::chrono::milliseconds;
  Sparing sparing;
  const Sparing::Clock::time_point begin = Sparing::Clock::now();
  for (const char* text : {"a", "b", "c"}) {
    EXPECT_TRUE(sparing.writes(text, begin)) << text;
    EXPECT_FALSE(sparing.writes(text, begin)) << text;
  }
  EXPECT_FALSE(sparing.writes("d", begin + milliseconds(999)));
  EXPECT_TRUE(sparing.writes("d", begin + milliseconds(1000))) << "it comes again";
  EXPECT_FALSE(sparing.writes("a", begin + milliseconds(5000)));
}

TEST(Sparing, WritesAHundredInAll) {
  Sparing sparing;
  const Sparing::Clock::time_point begin = Sparing::Clock::now();
  std::size_t written = 0;
  for (int n = 0; n < 1000; ++n)
    written += sparing.writes(std::to_string(n), begin + std::chrono::seconds(n)) ? 1 : 0;
  EXPECT_EQ(written, Sparing::most_in_all);
}

}  // namespace
}  // namespace palpa
