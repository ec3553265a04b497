// Colours as screens have them, and a space in which they are as far apart as they look.
#pragma once

#include <cstdint>

namespace palpa::drawing {

/// As on the screen (sRGB, gamma-encoded), each component 0..1.
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
/// What a screen cannot show is cut off at its limits.
Colour from_oklch(const Oklch& colour);
/// Whether a screen can show it.
bool on_screens(const Oklch& colour);

/// The colour of a value 0..1 of something that begins at nothing: from near black through violet, red and orange to a
/// light yellow. Perceptually even: equal steps are equal distances in Oklab, lightness rises all the way, so that the
/// order shows in grey, too. Values outside are those of the ends; NaN is a grey that is no value's.
Colour map_colour(double value);

}  // namespace palpa::drawing
