// The lines of help pages.
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "line/help.hpp"

namespace palpa::line {
namespace {

TEST(Help, LinesAreWrappedAtWords) {
  EXPECT_EQ(help_row("--a", "one two"), "  --a                       one two\n");
  EXPECT_EQ(help_row("--a-name-as-long-as-this-one N", "one"),
            "  --a-name-as-long-as-this-one N\n                            one\n");
  EXPECT_EQ(help_row("--a", ""), "  --a\n");
  std::string words;
  for (int i = 0; i < 60; ++i)
    words += "word ";
  std::istringstream lines(wrapped(words, 28));
  int count = 0;
  for (std::string text; std::getline(lines, text); ++count)
    EXPECT_LE(text.size(), help_columns) << text;
  EXPECT_EQ(count, 5);  // 14 words each
  const std::string long_word(120, 'x');
  EXPECT_EQ(wrapped("a " + long_word + " b", 2), "  a\n  " + long_word + "\n  b\n");
}

}  // namespace
}  // namespace palpa::line
