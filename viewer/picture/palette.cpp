#include "viewer/picture/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpa::viewer {

const Theme& theme_of(bool dark) {
  const auto make = [](bool night) {
    const auto pick = [&](const Colour& on_white, const Colour& on_black) { return night ? on_black : on_white; };
    return Theme{
        .background = pick(rgb(0xffffff), rgb(0x1c2127)),
        .ink = pick(rgb(0x1f2933), rgb(0xe8edf2)),
        .faint_ink = pick(rgb(0x66727f), rgb(0x9aa7b4)),
        .grid = pick(rgb(0x8a97a5, 0.28f), rgb(0x8a97a5, 0.18f)),
        .grid_major = pick(rgb(0x8a97a5, 0.62f), rgb(0x8a97a5, 0.42f)),
        .solid = pick(rgb(0x9db8d2, 0.30f), rgb(0x8fb2d6, 0.24f)),
        .solid_rim = pick(rgb(0x9db8d2, 0.55f), rgb(0xa9c8e8, 0.50f)),
        .edge = pick(rgb(0x2b3c4d), rgb(0xc9d8e8)),
        .skin = pick(rgb(0xd8a48a, 0.10f), rgb(0xe0ae95, 0.10f)),
        .skin_rim = pick(rgb(0xd8a48a, 0.55f), rgb(0xe0ae95, 0.50f)),
        .skin_point = pick(rgb(0xa08b80), rgb(0xb09a8e)),
        .dropped_point = pick(rgb(0xc9cdd2), rgb(0x545b63)),
        .loose_contact = pick(rgb(0x3a3a3a), rgb(0xd0d0d0)),
        .board = pick(rgb(0xaab4be, 0.10f), rgb(0x6c7884, 0.14f)),
        .board_edge = pick(rgb(0x66727f, 0.55f), rgb(0x9aa7b4, 0.5f)),
        .idle_transducer = pick(rgb(0xc3cad1), rgb(0x3c444d)),
        .frustum = pick(rgb(0x66727f, 0.75f), rgb(0x9aa7b4, 0.75f)),
        .tile = pick(rgb(0xe69f00), rgb(0xf0b429)),
    };
  };
  static const Theme themes[] = {make(false), make(true)};
  return themes[dark ? 1 : 0];
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
