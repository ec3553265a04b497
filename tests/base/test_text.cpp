#include <gtest/gtest.h>

#include <string>

#include "base/text.hpp"

namespace palpa {
namespace {

using namespace std::string_literals;

TEST(Text, ControlCharactersAreReplaced) {
  EXPECT_EQ(printable("plain, \xc3\xa9"), "plain, \xc3\xa9");
  EXPECT_EQ(printable("\0\t\n\r\x1b[31m\x7f"s), "?????[31m?");
  EXPECT_EQ(printable("a\nb", 10, ' '), "a b");
  EXPECT_EQ(printable(""), "");
}

TEST(Text, LongTextsAreCutBetweenCharacters) {
  EXPECT_EQ(printable("12345", 5), "12345");
  EXPECT_EQ(printable("123456", 5), "12345...");
  EXPECT_EQ(printable("1234\xc3\xa9", 5), "1234...");  // the character has two bytes, the second is the sixth
  EXPECT_EQ(printable("123\xc3\xa9z", 5), "123\xc3\xa9...");
  EXPECT_EQ(printable(std::string(100, '\x80'), 5), "...");  // no character begins anywhere
}

TEST(Text, MessagesLoseWhatEndsThem) {
  EXPECT_EQ(one_line("A thing\nis wrong. \n"), "A thing is wrong");
  EXPECT_EQ(one_line(" ... \n"), "");
  EXPECT_EQ(one_line(""), "");
  EXPECT_EQ(one_line("version 1.2.", 9), "version 1...");
}

}  // namespace
}  // namespace palpa
