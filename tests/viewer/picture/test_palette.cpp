#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

double decode(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
double luminance(const Colour& c) {
  return 0.2126 * decode(c.r) + 0.7152 * decode(c.g) + 0.0722 * decode(c.b);
}

TEST(Palette, FingersDifferAlsoForColourBlindEyes) {
  // Deuteranopia after Vienot, Brettel and Mollon, 1999: red and green collapse into one channel.
  const auto seen = [](const Colour& c) {
    const double r = decode(c.r), g = decode(c.g), b = decode(c.b);
    const double yellow = 0.2927 * r + 0.7073 * g;
    const double blue = -0.02234 * r + 0.02234 * g + b;
    return std::pair(std::cbrt(yellow), std::cbrt(std::max(blue, 0.0)));
  };
  for (std::uint32_t i = 0; i < 7; ++i) {
    for (std::uint32_t j = i + 1; j < 7; ++j) {
      const auto a = seen(finger_colour(i)), b = seen(finger_colour(j));
      EXPECT_GT(std::hypot(a.first - b.first, a.second - b.second), 0.07) << i << " and " << j;
    }
  }
  EXPECT_EQ(finger_colour(0).r, finger_colour(7).r);
}

TEST(Palette, BrightnessFollowsTheAmplitudeAndNotThePhase) {
  for (int step = 0; step < 24; ++step) {
    const auto phase = static_cast<float>(step * std::numbers::pi / 12);
    double last = -1;
    for (float amplitude = 0; amplitude <= 1.0f; amplitude += 0.125f) {
      const Colour c = drive_colour(amplitude, phase);
      EXPECT_GT(luminance(c), last);
      last = luminance(c);
      EXPECT_GE(std::min({c.r, c.g, c.b}), 0);
      EXPECT_LE(std::max({c.r, c.g, c.b}), 1);
    }
    EXPECT_NEAR(last, luminance(drive_colour(1, 0)), 0.06);
  }
}

TEST(Palette, HueIsPeriodicAndTellsPhasesApart) {
  const auto same = [](const Colour& a, const Colour& b) {
    return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
  };
  for (float phase = -3; phase < 3; phase += 0.37f) {
    EXPECT_LT(same(drive_colour(0.8f, phase), drive_colour(0.8f, phase + 2 * std::numbers::pi_v<float>)), 1e-3);
    EXPECT_GT(same(drive_colour(0.8f, phase), drive_colour(0.8f, phase + 0.5f)), 0.05);
  }
  const Colour broken = drive_colour(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isfinite(broken.r + broken.g + broken.b));
}

}  // namespace
}  // namespace palpa::viewer
