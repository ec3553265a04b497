// The chart of what skin feels: its place, the heights of its bars, and when it is not drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "viewer/picture/chart.hpp"
#include "viewer/render/overlay.hpp"

namespace palpa::viewer {
namespace {

std::vector<shader::ViewStroke> chart(const Picture& picture, double width = 1280, double height = 800) {
  std::vector<shader::ViewStroke> strokes;
  Ink ink(1, theme_of(false).background, strokes);
  draw_chart(ink, picture, width, height, theme_of(false));
  return strokes;
}

bool same_colour(const shader::ViewStroke& stroke, const Colour& colour) {
  return std::abs(stroke.colour.x - colour.r) < 1e-6F && std::abs(stroke.colour.y - colour.g) < 1e-6F &&
         std::abs(stroke.colour.z - colour.b) < 1e-6F && std::abs(stroke.colour.w - colour.a) < 1e-6F;
}

Picture with(std::vector<std::vector<SpectrumMark>> spectra) {
  Picture picture;
  picture.spectra = std::move(spectra);
  return picture;
}

TEST(Chart, TopsAreRound) {
  for (const auto& [most, top] : {std::pair(0.9, 1.0), {1, 1}, {1.1, 2}, {3, 5}, {0.07, 0.1}, {0, 1}, {-1, 1}})
    EXPECT_DOUBLE_EQ(chart_top(most), top) << most;
}

TEST(Chart, TheScaleStandsBesideItOrAboveIt) {
  const auto scale = [](double width) {
    std::vector<shader::ViewStroke> strokes;
    build_overlay(with({{{200, 1, 1}}}), {}, {}, {width, 600}, strokes);
    for (const shader::ViewStroke& s : strokes) {  // the one long line with ends at the right margin
      if (s.from.y == s.to.y && s.to.x == static_cast<float>(width - 24) && s.to.x - s.from.x > 20) return s;
    }
    ADD_FAILURE() << "no scale";
    return shader::ViewStroke{};
  };
  const double right = 504, top = 600 - 216;  // of the chart's panel
  const shader::ViewStroke wide = scale(1280), narrow = scale(540);
  EXPECT_GT(wide.from.x, right);
  EXPECT_GT(wide.from.y, top);
  EXPECT_LT(narrow.from.y, top);
}

TEST(Chart, BarsAreAsHighAsTheirLines) {
  // 200 Hz as high as the chart, 100 Hz half as high; half of the latter is felt.
  const auto strokes = chart(with({{{100, 0.5, 0.25}, {200, 1, 1}, {300, 0, 0}}}));
  std::vector<double> felt, pressure;
  for (const auto& s : strokes) {
    const double length = std::abs(s.to.y - s.from.y) + 6;  // with its round ends
    if (std::abs(s.to.x - s.from.x) > 0.01F || length < 8) continue;
    if (same_colour(s, finger_colour(0))) felt.push_back(length);
    if (same_colour(s, with_alpha(finger_colour(0), 0.32F))) pressure.push_back(length);
  }
  ASSERT_EQ(felt.size(), 2u);
  ASSERT_EQ(pressure.size(), 2u);
  EXPECT_NEAR(pressure[0], 0.5 * pressure[1], 0.01);
  EXPECT_NEAR(felt[0], 0.25 * pressure[1], 0.01);
  EXPECT_NEAR(felt[1], pressure[1], 0.01);
}

TEST(Chart, WhatIsLookedAtMakesRoomForItWhereItIsDrawn) {
  const Picture picture = with({{{200, 1, 1}}});
  EXPECT_TRUE(chart(with({})).empty()) << "no spectra";
  EXPECT_EQ(chart_share(with({}), 1280, 800, 1), 0);
  EXPECT_TRUE(chart(picture, 320, 200).empty()) << "no room";
  EXPECT_EQ(chart_share(picture, 400, 800, 1), 0);
  double right = 0;
  for (const auto& s : chart(picture))
    right = std::max({right, double{s.from.x}, double{s.to.x}});
  EXPECT_NEAR(chart_share(picture, 1280, 800, 1), right / 1280, 0.01);
  EXPECT_DOUBLE_EQ(chart_share(picture, 2560, 1600, 2), chart_share(picture, 1280, 800, 1));
}

TEST(Chart, StaysInItsCorner) {
  std::vector<std::vector<SpectrumMark>> many(9);
  for (auto& spectrum : many)
    for (int i = 1; i < 60; ++i)
      spectrum.push_back({i * 16.0, 2.0 / i, 1.0 / i});
  const auto lines = chart(with(many));
  EXPECT_GT(lines.size(), 60u);
  for (const auto& s : lines) {
    for (const auto& end : {s.from, s.to}) {
      EXPECT_TRUE(end.x > 95 && end.x < 530) << end.x;
      EXPECT_TRUE(end.y > 570 && end.y < 800) << end.y;
    }
  }
}

TEST(Overlay, ScaleBarIsOneTwoOrFive) {
  for (const auto& [most, length] : {std::pair(0.0123, 0.01), {0.0999, 0.05}, {0.02, 0.02}, {0.1, 0.1}})
    EXPECT_NEAR(scale_bar_length(most), length, 1e-12);
  for (const double odd : {0.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_GT(scale_bar_length(odd), 0);
}

}  // namespace
}  // namespace palpa::viewer
