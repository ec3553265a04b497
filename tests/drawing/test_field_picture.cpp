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

TEST(FieldPicture, EachTextIsBesideWhatItNames) {
  const std::vector<double> values{1, 2, 0, 1};
  const FieldPicture usual = picture_of(values, 2, {40, 40});
  FieldPicture across = usual, upwards = usual;
  across.right = "y";
  across.title = "a tithe";
  upwards.up = "y";
  upwards.unit = "Pa, beak";
  const Pixels before = draw(usual);
  // Whether a part differs from what it was. Sides are shares of the picture, from the left and from the top.
  const auto differs = [&](const Pixels& now, double left, double right, double top, double bottom) {
    const auto of = [](double share, std::uint32_t whole) { return static_cast<std::uint32_t>(share * whole); };
    for (std::uint32_t y = of(top, now.height); y < of(bottom, now.height); ++y) {
      const auto first = of(left, now.width), last = of(right, now.width);
      if (!std::equal(now.at(first, y), now.at(last - 1, y), before.at(first, y))) return true;
    }
    return false;
  };
  for (const bool up : {false, true}) {
    const Pixels now = draw(up ? upwards : across);
    ASSERT_EQ(now.rgba.size(), before.rgba.size());
    EXPECT_NE(differs(now, 0.2, 0.8, 0.9, 1), up) << "the axis to the right";
    EXPECT_NE(differs(now, 0, 1, 0, 0.05), up) << "the title";
    EXPECT_EQ(differs(now, 0, 0.08, 0.2, 0.8), up) << "the axis upwards";
    EXPECT_EQ(differs(now, 0.75, 1, 0.05, 0.25), up) << "the colour bar";
    EXPECT_FALSE(differs(now, 0.25, 0.7, 0.2, 0.8)) << "the map";
  }
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
