// Colours and the colour map: even, in order, also without colour.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drawing/colour.hpp"

namespace palpa::drawing {
namespace {

double decode(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// From the screen's colours back to Oklab, with its author's matrices for this direction.
std::array<double, 3> oklab(const Colour& c) {
  const double r = decode(c.r), g = decode(c.g), b = decode(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
          1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
          0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

double apart(const Colour& one, const Colour& other) {
  const auto p = oklab(one), q = oklab(other);
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(Colours, OklchAgreesWithOklab) {
  const auto lab = oklab(from_oklch({0.6F, 0.1F, 1.0F}));
  EXPECT_NEAR(lab[0], 0.6, 1e-4);
  EXPECT_NEAR(lab[1], 0.1 * std::cos(1.0), 1e-4);
  EXPECT_NEAR(lab[2], 0.1 * std::sin(1.0), 1e-4);
  EXPECT_TRUE(on_screens({0.6F, 0.1F, 1.0F}));
  EXPECT_FALSE(on_screens({0.6F, 0.4F, 1.0F}));
}

TEST(MapColour, StepsAreEvenAndLightnessRises) {
  constexpr int steps = 50;
  double least = 1, most = 0;
  for (int i = 0; i < steps; ++i) {
    const Colour a = map_colour(static_cast<double>(i) / steps), b = map_colour((i + 1.0) / steps);
    least = std::min(least, apart(a, b));
    most = std::max(most, apart(a, b));
    EXPECT_GT(oklab(b)[0], oklab(a)[0] + 0.005) << i;
  }
  EXPECT_LT(most / least, 1.1);
  EXPECT_LT(oklab(map_colour(0))[0], 0.2);
  EXPECT_GT(oklab(map_colour(1))[0], 0.9);
}

TEST(MapColour, TakesValuesBeyondItsEndsAndNaN) {
  EXPECT_EQ(apart(map_colour(-3), map_colour(0)), 0);
  EXPECT_EQ(apart(map_colour(7), map_colour(1)), 0);
  const Colour none = map_colour(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i <= 100; ++i)
    EXPECT_GT(apart(none, map_colour(i / 100.0)), 0.05);
}

}  // namespace
}  // namespace palpa::drawing
