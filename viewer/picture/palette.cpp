#include "viewer/picture/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpa::viewer {
const Theme& light_theme() {
  static const Theme theme{
      .background = rgb(0xffffff),
      .ink = rgb(0x1f2933),
      .faint_ink = rgb(0x66727f),
      .grid = rgb(0x8a97a5, 0.28f),
      .grid_major = rgb(0x8a97a5, 0.62f),
      .solid = rgb(0x9db8d2, 0.30f),
      .solid_rim = rgb(0x9db8d2, 0.55f),
      .edge = rgb(0x2b3c4d),
      .skin = rgb(0xd8a48a, 0.10f),
      .skin_rim = rgb(0xd8a48a, 0.55f),
      .skin_point = rgb(0xa08b80),
      .dropped_point = rgb(0xc9cdd2),
      .loose_contact = rgb(0x3a3a3a),
      .board = rgb(0xaab4be, 0.10f),
      .board_edge = rgb(0x66727f, 0.55f),
      .idle_transducer = rgb(0xc3cad1),
      .frustum = rgb(0x66727f, 0.75f),
      .tile = rgb(0xe69f00),
  };
  return theme;
}

const Theme& dark_theme() {
  static const Theme theme{
      .background = rgb(0x1c2127),
      .ink = rgb(0xe8edf2),
      .faint_ink = rgb(0x9aa7b4),
      .grid = rgb(0x8a97a5, 0.18f),
      .grid_major = rgb(0x8a97a5, 0.42f),
      .solid = rgb(0x8fb2d6, 0.24f),
      .solid_rim = rgb(0xa9c8e8, 0.50f),
      .edge = rgb(0xc9d8e8),
      .skin = rgb(0xe0ae95, 0.10f),
      .skin_rim = rgb(0xe0ae95, 0.50f),
      .skin_point = rgb(0xb09a8e),
      .dropped_point = rgb(0x545b63),
      .loose_contact = rgb(0xd0d0d0),
      .board = rgb(0x6c7884, 0.14f),
      .board_edge = rgb(0x9aa7b4, 0.5f),
      .idle_transducer = rgb(0x3c444d),
      .frustum = rgb(0x9aa7b4, 0.75f),
      .tile = rgb(0xf0b429),
  };
  return theme;
}

std::uint32_t to_pixel(const Colour& colour) {
  const auto byte = [](float v) { return static_cast<std::uint32_t>(std::lround(std::clamp(v, 0.0f, 1.0f) * 255)); };
  return byte(colour.r) | byte(colour.g) << 8 | byte(colour.b) << 16 | byte(colour.a) << 24;
}

Colour finger_colour(std::uint32_t index) {
  // Okabe and Ito, "Color Universal Design", 2008; the darker ones first, because they stand out on white.
  static constexpr std::array<std::uint32_t, 7> colours{0xd55e00, 0x0072b2, 0x009e73, 0xcc79a7,
                                                        0xe69f00, 0x56b4e9, 0xf0e442};
  return rgb(colours[index % colours.size()]);
}

Colour drive_colour(float amplitude, float phase) {
  const float a = std::isfinite(amplitude) ? std::clamp(amplitude, 0.0f, 1.0f) : 0.0f;
  const float hue = (std::isfinite(phase) ? phase : 0.0f) + 0.7f;
  return drawing::from_oklch({0.22f + 0.53f * a, 0.122f * a, hue});
}

Colour part_colour(Colour solid, std::uint32_t index) {
  // The golden angle: the hues of the first dozen all differ clearly.
  return with_alpha(mix(solid, drive_colour(1, 2.399963f * static_cast<float>(index)), 0.6f), solid.a);
}

}  // namespace palpa::viewer
