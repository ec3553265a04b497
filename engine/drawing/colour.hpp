// Screen colours, and a perceptually uniform colour space.
#pragma once

#include <cstdint>

namespace palpa::drawing {

/// As on the screen (sRGB, gamma-encoded), each component in 0..1.
struct Colour {
  float r = 0, g = 0, b = 0, a = 1;
};
constexpr Colour rgb(std::uint32_t hex, float alpha = 1) {
  return {static_cast<float>(hex >> 16 & 255u) / 255.0f, static_cast<float>(hex >> 8 & 255u) / 255.0f,
          static_cast<float>(hex & 255u) / 255.0f, alpha};
}
constexpr Colour with_alpha(Colour c, float alpha) {
  return {c.r, c.g, c.b, alpha};
}
Colour mix(Colour a, Colour b, float t);

/// Oklab (Ottosson 2020) in polar form: lightness 0..1, chroma from 0 (grey), hue in radians.
struct Oklch {
  float lightness = 0, chroma = 0, hue = 0;
};
/// Colours outside the screen's range are clamped.
Colour from_oklch(const Oklch& colour);
/// Whether the colour is within the screen's range.
bool on_screens(const Oklch& colour);

/// The colour of a value in 0..1 on a scale that starts at zero: from near black through violet, red and orange to a
/// light yellow. Perceptually uniform: equal steps are equal distances in Oklab, and lightness always rises, so that
/// the order also shows in grey. Values outside are clamped; NaN is a grey that no value has.
Colour map_colour(double value);

}  // namespace palpa::drawing
