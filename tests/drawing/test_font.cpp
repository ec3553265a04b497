#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "drawing/font.hpp"

namespace palpa::drawing {
namespace {

std::vector<PenStroke> strokes_of(const std::string& text, double height = 70) {
  std::vector<PenStroke> strokes;
  write_text(text, {0, 0}, height, strokes);
  return strokes;
}

/// ASCII, and the letters of Western European languages.
std::vector<std::string> characters() {
  std::vector<std::string> all;
  for (std::uint32_t code = '!'; code <= 0xff; ++code) {
    if (code <= '~' || (code >= 0xc0 && code != 0xf7)) all.push_back(utf8(code));
  }
  all.insert(all.end(), {"\u0152", "\u0153"});
  return all;
}

TEST(Font, HasEveryPrintableCharacterAndAllDiffer) {
  const auto box = strokes_of("\xff");
  const auto drawing_of = [](const std::vector<PenStroke>& strokes) {
    std::string drawing;
    for (const PenStroke& s : strokes) {
      drawing += std::to_string(s.from.x) + " " + std::to_string(s.from.y) + " " + std::to_string(s.to.x) + " " +
                 std::to_string(s.to.y) + ";";
    }
    return drawing;
  };
  std::set<std::string> drawings{drawing_of(box)};
  for (const std::string& c : characters()) {
    const auto strokes = strokes_of(c);
    ASSERT_FALSE(strokes.empty()) << c;
    EXPECT_TRUE(drawings.insert(drawing_of(strokes)).second) << c << " looks like another character, or is a box";
  }
  EXPECT_TRUE(strokes_of(" ").empty());
  EXPECT_EQ(strokes_of("\u4e2d").size(), box.size());  // a missing glyph is a box
}

TEST(Font, StaysInsideItsWidthAndHeight) {
  for (const std::string& c : characters()) {
    const bool marked = c.size() > 1;
    const double width = text_width(c, 70), beside = marked ? 10 : 1;
    const double above = marked ? 98 : 85;  // a little above capitals, for brackets and marks
    for (const PenStroke& s : strokes_of(c)) {
      for (const Vec2& p : {s.from, s.to}) {
        EXPECT_GE(p.x, -beside) << c;
        EXPECT_LE(p.x, width + beside) << c;
        EXPECT_GE(p.y, -above) << c;
        EXPECT_LE(p.y, 25) << c;
      }
    }
  }
  double highest = 0;
  for (const PenStroke& s : strokes_of("H"))
    highest = std::min({highest, s.from.y, s.to.y});
  EXPECT_NEAR(highest, -70, 1e-9);
}

TEST(Font, WidthsAddUpAndDigitsAreEquallyWide) {
  EXPECT_EQ(text_width("", 10), 0);
  for (char c = '0'; c <= '9'; ++c)
    EXPECT_EQ(text_width(std::string(1, c), 10), text_width("0", 10));
  EXPECT_GT(text_width("mm", 10), 2 * text_width("m", 10));
  EXPECT_NEAR(text_width("scale", 20), 2 * text_width("scale", 10), 1e-9);
}

TEST(Font, SurvivesBrokenUtf8) {
  for (const char* text : {"\x80", "\xc3", "a\xe2\x82", "\xf0\x9f\x98\x80", "\xc3(", "\xe2\x28\xa1"}) {
    EXPECT_FALSE(strokes_of(text).empty());
    EXPECT_GT(text_width(text, 10), 0);
  }
  EXPECT_NE(strokes_of("\u03c0").size(), strokes_of("\xff").size());
}

}  // namespace
}  // namespace palpa::drawing
