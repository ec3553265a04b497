#include "drawing/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpa::drawing {
namespace {

float encode(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
}

struct Lab {
  float lightness, a, b;
};
Lab lab(const Oklch& c) {
  return {c.lightness, c.chroma * std::cos(c.hue), c.chroma * std::sin(c.hue)};
}
float apart(const Oklch& one, const Oklch& other) {
  const Lab p = lab(one), q = lab(other);
  return std::hypot(p.lightness - q.lightness, p.a - q.a, p.b - q.b);
}

/// Björn Ottosson's Oklab (2020) to linear red, green and blue.
std::array<float, 3> linear(const Oklch& colour) {
  const auto [lightness, a, b] = lab(colour);
  const auto cube = [](float v) { return v * v * v; };
  const float l = cube(lightness + 0.3963377774f * a + 0.2158037573f * b);
  const float m = cube(lightness - 0.1055613458f * a - 0.0638541728f * b);
  const float s = cube(lightness - 0.0894841775f * a - 1.2914855480f * b);
  return {4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s,
          -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s,
          -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s};
}

/// The map's path through the colours, not yet uniform: as colourful as screens allow, with a small margin.
Oklch on_the_way(double t) {
  constexpr double first_hue = 285, last_hue = 465;  // degrees: violet, then red and orange, to yellow
  Oklch colour;
  colour.lightness = static_cast<float>(0.13 + 0.84 * t);
  colour.hue = static_cast<float>((first_hue + (last_hue - first_hue) * t) * std::numbers::pi / 180);
  colour.chroma = static_cast<float>(0.04 + 0.16 * std::sin(std::numbers::pi * std::clamp(t, 0.0, 1.0)));
  if (on_screens(colour)) return colour;
  float shown = 0, beyond = colour.chroma;
  for (int i = 0; i < 16; ++i) {
    colour.chroma = (shown + beyond) / 2;
    (on_screens(colour) ? shown : beyond) = colour.chroma;
  }
  colour.chroma = shown;
  return colour;
}

constexpr std::size_t map_steps = 256;

/// Colours at equal distances along that path.
std::array<Colour, map_steps + 1> make_map() {
  constexpr std::size_t fine = 8192;
  std::array<Oklch, fine + 1> way;
  std::array<float, fine + 1> length{};
  for (std::size_t i = 0; i <= fine; ++i) {
    way[i] = on_the_way(static_cast<double>(i) / fine);
    if (i > 0) length[i] = length[i - 1] + apart(way[i], way[i - 1]);
  }
  std::array<Colour, map_steps + 1> map;
  for (std::size_t i = 0, at = 0; i <= map_steps; ++i) {
    const float wanted = length[fine] * static_cast<float>(i) / static_cast<float>(map_steps);
    while (at < fine && length[at] < wanted)
      ++at;
    map[i] = from_oklch(way[at]);
  }
  return map;
}

}  // namespace

Colour mix(Colour a, Colour b, float t) {
  return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t, a.a + (b.a - a.a) * t};
}

Colour from_oklch(const Oklch& colour) {
  const auto [r, g, b] = linear(colour);
  return {encode(r), encode(g), encode(b), 1.0f};
}

bool on_screens(const Oklch& colour) {
  return std::ranges::all_of(linear(colour), [](float c) { return c >= -1e-4f && c <= 1.0001f; });
}

Colour map_colour(double value) {
  static const std::array<Colour, map_steps + 1> map = make_map();
  if (std::isnan(value)) return rgb(0x9aa3ad);
  const double at = std::clamp(value, 0.0, 1.0) * map_steps;
  const std::size_t step = std::min(static_cast<std::size_t>(at), map_steps - 1);
  return mix(map[step], map[step + 1], static_cast<float>(at - static_cast<double>(step)));
}

}  // namespace palpa::drawing
