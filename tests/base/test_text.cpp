#include <gtest/gtest.h>

#include <string>

#include "base/files/without_folders.hpp"
#include "base/text.hpp"

namespace palpa {
namespace {

using namespace std::string_literals;

TEST(Text, InvisibleCharactersAreEscaped) {
  EXPECT_EQ(printable("plain, \xc3\xa9"), "plain, \xc3\xa9");
  EXPECT_EQ(printable("\0\t\n\r\x1b[31m\x7f"s), "\\x00\\t\\n\\r\\x1b[31m\\x7f");
  EXPECT_EQ(printable("a\xff\xc3"), "a\\xff\\xc3");
  EXPECT_EQ(printable("\xc2\x9b|\xe2\x80\xae|\xe2\x81\xa6|\xef\xbb\xbf"), "\\u009b|\\u202e|\\u2066|\\ufeff");
  EXPECT_EQ(printable("\xf0\x9f\x91\x86"), "\xf0\x9f\x91\x86");
  EXPECT_EQ(printable(""), "");
}

TEST(Text, LongLinesLoseTheirMiddle) {
  EXPECT_EQ(shortened("123456789", 9), "123456789");
  EXPECT_EQ(shortened("1234567890ab", 9), "1234...ab");
  const std::string long_one = shortened("begin " + std::string(1000, 'x') + " end", 500);
  EXPECT_EQ(long_one.size(), 500u);
  EXPECT_TRUE(long_one.starts_with("begin xxx") && long_one.ends_with("xxx end")) << long_one;
  std::string accents;
  for (int i = 0; i < 300; ++i)
    accents += "\xc3\xa9";
  for (std::size_t most = 100; most < 110; ++most) {
    const std::string cut = shortened(accents, most);
    EXPECT_LE(cut.size(), most);
    EXPECT_EQ(printable(cut), cut) << "a character was cut in two";
  }
}

TEST(Text, LongTextsAreCutBetweenCharacters) {
  EXPECT_EQ(printable("12345", 5), "12345");
  EXPECT_EQ(printable("123456", 5), "12345...");
  EXPECT_EQ(printable("1234\xc3\xa9", 5), "1234...");  // the character has two bytes, the second is the sixth
  EXPECT_EQ(printable("123\xc3\xa9z", 5), "123\xc3\xa9...");
  EXPECT_EQ(printable(std::string(100, '\x80'), 5), "\\x80...");  // no escape is cut in two
}

TEST(Text, MessagesLoseTheirFinalDots) {
  EXPECT_EQ(one_line("A thing\nis wrong. \n"), "A thing is wrong");
  EXPECT_EQ(one_line(" ... \n"), "");
  EXPECT_EQ(one_line(""), "");
  EXPECT_EQ(one_line("version 1.2.", 9), "version 1...");
}

TEST(Text, ThingsAreCounted) {
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(2, "skin point"), "2 skin points");
  EXPECT_EQ(counted(1, "focus") + counted(3, "focus"), "1 focus3 foci");
  EXPECT_EQ(counted(4, "vertex") + counted(1, "body") + counted(5, "body"), "4 vertices1 body5 bodies");
  EXPECT_EQ(counted(2, "touch") + counted(2, "process") + counted(2, "day") + counted(2, "survey"),
            "2 touches2 processes2 days2 surveys");
  EXPECT_EQ(first_is("node 3", 1) + "; " + first_is("node 3", 2) + "; " + first_is("node 3", 3),
            "node 3 is; node 3 and 1 other are; node 3 and 2 others are");
  EXPECT_EQ(plural(1, "case") + plural(12, "case"), "casecases");
}

TEST(Text, CellsAreQuotedIfTheyWouldBeSplit) {
  EXPECT_EQ(csv_cell("plain text"), "plain text");
  EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_cell("a\"b\nc"), "\"a\"\"b\nc\"");
}

TEST(Text, FoldersAreLeftOutOfMessages) {
  EXPECT_EQ(without_folders("/data/alice/rig.toml: is empty"), "rig.toml: is empty");
  EXPECT_EQ(without_folders("recording:/data/alice/take: cannot read '../bob/x.png'"),
            "recording:take: cannot read 'x.png'");
  EXPECT_EQ(without_folders("/dev/video0 is gone"), "/dev/video0 is gone");
  EXPECT_EQ(without_folders("alice/rig.toml, 90 frames/s, / and nothing else"),
            "rig.toml, 90 frames/s, / and nothing else");
  EXPECT_EQ(without_folders(""), "");
}

}  // namespace
}  // namespace palpa
