#include "drawing/line_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "drawing/axes.hpp"

namespace palpa::drawing {
namespace {

struct Rgb {
  int r, g, b;
};

Rgb at(const Pixels& pixels, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = pixels.at(x, y);
  return {p[0], p[1], p[2]};
}
bool is_curve(const Rgb& c) {
  return c.b - c.r > 90 && c.r < 80;
}
bool is_band(const Rgb& c) {
  return c.r == 0xbd && c.g == 0xd3 && c.b == 0xea;
}

/// The chart of a picture without notes: its left and top edges, and its size.
struct Chart {
  Pixels pixels;
  std::uint32_t left = 0, top = 0, width = 0, height = 0;

  explicit Chart(const LinePicture& picture) : pixels(draw(picture)) {
    left = drawing::pixels(30 + axis_letters) + marks(0, picture.most, 8).width();
    top = drawing::pixels(34 + 15 * static_cast<double>(picture.notes.size()));
    width = drawing::pixels(560);
    height = drawing::pixels(300);
  }
  /// The value, in the axis' unit, of the highest and lowest pixel of a kind above the place `part` of the line.
  std::optional<Vec2> extent(double part, double most, bool (*kind)(const Rgb&)) const {
    const std::uint32_t x = left + static_cast<std::uint32_t>(std::lround(part * (width - 1)));
    std::optional<Vec2> range;
    for (std::uint32_t y = top; y < top + height; ++y) {
      if (!kind(at(pixels, x, y))) continue;
      const double value = (1 - (y - top) / (height - 1.0)) * most;
      if (!range) range = Vec2(value, value);
      range->y = value;
    }
    return range;
  }
};

LinePicture ramp(const std::vector<double>& values) {
  LinePicture picture;
  picture.values = values;
  picture.length_mm = 40;
  picture.along = "x";
  picture.title = "A ramp";
  picture.most = 100;
  picture.unit = "Pa";
  return picture;
}

TEST(LinePicture, TheCurveIsWhereItsValuesAre) {
  const std::vector<double> values{20, 40, 60, 80};
  const Chart chart(ramp(values));
  for (const double part : {0.1, 1.0 / 3, 0.5, 0.8}) {
    const auto range = chart.extent(part, 100, is_curve);
    ASSERT_TRUE(range) << part;
    EXPECT_NEAR((range->x + range->y) / 2, 20 + 60 * part, 0.5) << part;
    EXPECT_FALSE(chart.extent(part, 100, is_band));
  }
}

TEST(LinePicture, TheBandLiesBetweenItsEdges) {
  const std::vector<double> values(5, 50), low(5, 30), high{70, 75, 80, 85, 90};
  LinePicture picture = ramp(values);
  picture.low = low;
  picture.high = high;
  const Chart chart(picture);
  for (const double part : {0.1, 0.5, 0.9}) {
    const auto range = chart.extent(part, 100, is_band);
    ASSERT_TRUE(range);
    EXPECT_NEAR(range->x, 70 + 20 * part, 0.5);
    EXPECT_NEAR(range->y, 30, 0.5);
  }
}

/// A scale turns values into the axis' unit.
TEST(LinePicture, ValuesAreScaled) {
  const std::vector<double> values(3, 20'000);
  LinePicture picture = ramp(values);
  picture.most = 1;
  picture.scale = 1 / 40'000.0;
  const auto range = Chart(picture).extent(0.5, 1, is_curve);
  ASSERT_TRUE(range);
  EXPECT_NEAR((range->x + range->y) / 2, 0.5, 0.01);
}

/// The middles of the runs of rows beside the chart in which any of these columns is dark.
std::vector<double> dark_rows(const Chart& chart, std::uint32_t from, std::uint32_t to) {
  std::vector<double> middles;
  std::optional<std::uint32_t> begin;
  const std::uint32_t margin = pixels(6);  // half a number, and less than the distance of other text
  for (std::uint32_t y = chart.top - margin; y < chart.top + chart.height + margin; ++y) {
    bool dark = false;
    for (std::uint32_t x = from; x < to; ++x)
      dark = dark || at(chart.pixels, x, y).r < 0x80;
    if (dark && !begin) begin = y;
    if (dark || !begin) continue;
    middles.push_back((*begin + y - 1) / 2.0);
    begin.reset();
  }
  return middles;
}

/// The lines and the numbers of the upright axis are where their values are, whatever the scale of the curve is.
TEST(LinePicture, TheNumbersOfTheUprightAxisAreAtTheirValues) {
  const std::vector<double> values(3, 40);
  for (const auto& [most, scale] :
       {std::pair(100.0, 1.0), std::pair(75.0, 1.0), std::pair(1.0, 1 / 40.0), std::pair(1.0, 1 / 40'000.0)}) {
    LinePicture picture = ramp(values);
    picture.most = most;
    picture.scale = scale;
    const Chart chart(picture);
    const Marks up = marks(0, most, 8);
    std::vector<double> rows;
    for (const double value : up.at)
      rows.insert(rows.begin(), chart.top + (1 - value / most) * (chart.height - 1));
    const std::vector<double> lines = dark_rows(chart, chart.left - pixels(3), chart.left - pixels(2));
    const std::vector<double> numbers = dark_rows(chart, chart.left - pixels(8) - up.width(), chart.left - pixels(7));
    ASSERT_EQ(lines.size(), rows.size()) << most << " " << scale;
    ASSERT_EQ(numbers.size(), rows.size()) << most << " " << scale;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_NEAR(lines[i], rows[i], 1) << most << " " << scale;
      EXPECT_NEAR(numbers[i], rows[i], 2) << most << " " << scale;
    }
  }
}

/// A single loud sample among many must not fall between two pixels.
TEST(LinePicture, NoPeakIsLost) {
  std::vector<double> values(100'000, 10);
  values[43'210] = 95;
  const auto range = Chart(ramp(values)).extent(43'210 / 99'999.0, 100, is_curve);
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->x, 95, 1);
  EXPECT_NEAR(range->y, 10, 1);
}

TEST(LinePicture, WhatIsNoNumberIsAGap) {
  std::vector<double> values(101, 50);
  values[50] = std::numeric_limits<double>::quiet_NaN();
  const Chart chart(ramp(values));
  EXPECT_FALSE(chart.extent(0.5, 100, is_curve));
  EXPECT_TRUE(chart.extent(0.45, 100, is_curve));
  EXPECT_TRUE(chart.extent(0.55, 100, is_curve));
}

TEST(LinePicture, ASilentLineIsDrawnToo) {
  const std::vector<double> values(2, 0);
  LinePicture picture = ramp(values);
  picture.most = 0;
  EXPECT_GT(draw(picture).width, 1000u);
}

}  // namespace
}  // namespace palpa::drawing
