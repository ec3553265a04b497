// The picture of a plane: the places of its parts, and nothing is cut off.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "drawing/axes.hpp"
#include "drawing/canvas.hpp"
#include "drawing/colour.hpp"
#include "drawing/field_picture.hpp"

namespace palpa::drawing {
namespace {

FieldPicture picture_of(const std::vector<double>& values, std::uint32_t columns, const Vec2& size_mm) {
  FieldPicture picture;
  picture.values = values;
  picture.columns = columns;
  picture.rows = static_cast<std::uint32_t>(values.size() / columns);
  picture.low_mm = size_mm * -0.5;
  picture.high_mm = size_mm * 0.5;
  picture.right = "x";
  picture.up = "z";
  picture.title = "a title";
  picture.notes = {"a note that is longer than the map is wide, to see that the sheet grows with it"};
  picture.most = *std::max_element(values.begin(), values.end());
  picture.unit = "Pa, peak";
  return picture;
}

bool is(const Pixels& pixels, std::uint32_t x, std::uint32_t y, const Colour& colour) {
  const auto near = [](int byte, float part) {
    return std::abs(byte - static_cast<int>(std::lround(part * 255))) <= 2;
  };
  const std::uint8_t* const at = pixels.at(x, y);
  return near(at[0], colour.r) && near(at[1], colour.g) && near(at[2], colour.b);
}

bool white(const Pixels& pixels, std::uint32_t x, std::uint32_t y) {
  return is(pixels, x, y, rgb(0xffffff));
}

TEST(FieldPicture, HasItsValuesInTheirPlaces) {
  // The brightest is at the top right, the darkest at the bottom left.
  const Pixels pixels = draw(picture_of({1, 2, 0, 1}, 2, {40, 40}));
  const auto first_in_row = [&](std::uint32_t y, const Colour& colour) {
    std::uint32_t x = 0;
    while (x < pixels.width && !is(pixels, x, y, colour))
      ++x;
    return x;
  };
  std::uint32_t top = 0;
  while (top < pixels.height && first_in_row(top, map_colour(0.5)) == pixels.width)
    ++top;
  ASSERT_LT(top, pixels.height);
  const std::uint32_t left = first_in_row(top + 900, map_colour(0));
  ASSERT_LT(left, pixels.width);
  EXPECT_TRUE(is(pixels, left + 930, top + 40, map_colour(1)));
  EXPECT_TRUE(is(pixels, left + 20, top + 930, map_colour(0)));
  EXPECT_TRUE(is(pixels, left + 20, top + 40, map_colour(0.5)));
}

TEST(FieldPicture, NothingIsCutOffWhateverItsShape) {
  const std::vector<double> values(4000, 1);
  const struct {
    std::uint32_t columns;
    Vec2 size_mm;
  } shapes[]{{40, {40, 100}}, {4000, {400, 0.1}}, {1, {0.1, 400}}, {100, {1e-3, 1e-3}}, {80, {1e5, 5e4}}};
  for (const auto& [columns, size_mm] : shapes) {
    const Pixels pixels = draw(picture_of(values, columns, size_mm));
    ASSERT_LT(std::max(pixels.width, pixels.height), 6000u);
    for (std::uint32_t x = 0; x < pixels.width; ++x)
      ASSERT_TRUE(white(pixels, x, 2) && white(pixels, x, pixels.height - 3)) << columns << " " << x;
    for (std::uint32_t y = 0; y < pixels.height; ++y)
      ASSERT_TRUE(white(pixels, 2, y) && white(pixels, pixels.width - 3, y)) << columns << " " << y;
  }
}

/// The pixels that differ, from the first to the last along each axis. The pictures have one size.
struct Difference {
  std::uint32_t left, right, top, bottom;
};
Difference difference(const Pixels& a, const Pixels& b) {
  Difference out{a.width, 0, a.height, 0};
  EXPECT_EQ(a.rgba.size(), b.rgba.size());
  for (std::uint32_t y = 0; y < std::min(a.height, b.height); ++y) {
    for (std::uint32_t x = 0; x < std::min(a.width, b.width); ++x) {
      if (std::equal(a.at(x, y), a.at(x, y) + 3, b.at(x, y))) continue;
      out = {std::min(out.left, x), std::max(out.right, x), std::min(out.top, y), std::max(out.bottom, y)};
    }
  }
  return out;
}

TEST(FieldPicture, EachTextIsBesideWhatItNames) {
  const std::vector<double> values{1, 2, 0, 1};
  const FieldPicture usual = picture_of(values, 2, {40, 40});
  const Pixels before = draw(usual);
  const auto changed = [&](const auto& change) {
    FieldPicture picture = usual;
    change(picture);
    return difference(before, draw(picture));
  };
  const std::uint32_t wide = before.width, high = before.height;
  const Difference right = changed([](FieldPicture& p) { p.right = "y"; });
  EXPECT_GT(right.top, high * 9 / 10);
  EXPECT_TRUE(right.left > wide / 4 && right.right < wide * 3 / 4) << right.left;
  const Difference up = changed([](FieldPicture& p) { p.up = "y"; });
  EXPECT_LT(up.right, wide / 10);
  EXPECT_TRUE(up.top > high / 4 && up.bottom < high * 3 / 4) << up.top;
  const Difference title = changed([](FieldPicture& p) { p.title = "a tithe"; });
  EXPECT_LT(title.bottom, high / 20);
  const Difference note = changed([](FieldPicture& p) { p.notes[0][0] = 'e'; });
  EXPECT_TRUE(note.top > title.bottom && note.bottom < high / 10) << note.top;
  const Difference unit = changed([](FieldPicture& p) { p.unit = "Pa, beak"; });
  EXPECT_GT(unit.left, wide * 3 / 4);
  EXPECT_LT(unit.bottom, high / 4);
}

TEST(FieldPicture, SilenceIsDrawn) {
  const std::vector<double> nothing(9, 0);
  const Pixels pixels = draw(picture_of(nothing, 3, {10, 10}));
  EXPECT_TRUE(is(pixels, pixels.width / 2, pixels.height / 2, map_colour(0)));
}

TEST(Ticks, AreRoundAndInside) {
  EXPECT_EQ(ticks(-30, 30, 7), (std::vector<double>{-30, -20, -10, 0, 10, 20, 30}));
  EXPECT_EQ(ticks(0, 1, 6), (std::vector<double>{0, 0.2, 0.4, 0.2 * 3, 0.8, 1}));
  EXPECT_LE(ticks(0.13, 97.2, 5).size(), 5u);
  EXPECT_GE(ticks(0.13, 97.2, 5).size(), 2u);
  EXPECT_TRUE(ticks(1, 1, 5).empty());
  EXPECT_TRUE(ticks(0, NAN, 5).empty());
  EXPECT_EQ(tick_label(-12.5, 0.5), "\u221212.5");
  EXPECT_EQ(tick_label(-0.0, 5), "0");
  EXPECT_EQ(tick_label(4000, 1000), "4000");
}

TEST(Canvas, DrawsWhatIsInsideOfIt) {
  Canvas canvas(10, 10, rgb(0xffffff));
  const shader::ViewStroke strokes[]{{{-50, 5, 0, 1}, {50, 5, 0, 0}, {0, 0, 0, 1}},
                                     {{3.5, 0.5, 0, 1}, {3.5, 0.5, 0, 0}, {1, 0, 0, 0.5F}}};
  canvas.draw(strokes);
  canvas.set(10, 3, rgb(0));
  const Pixels& pixels = canvas.pixels();
  for (std::uint32_t x = 0; x < 10; ++x) {
    EXPECT_TRUE(is(pixels, x, 4, rgb(0)) && is(pixels, x, 5, rgb(0)));
    EXPECT_TRUE(white(pixels, x, 8));
  }
  EXPECT_TRUE(is(pixels, 3, 0, rgb(0xff8080)));
}

}  // namespace
}  // namespace palpa::drawing
