// Every colour of the pictures. Fingers use the palette of Okabe and Ito, which colour-blind people can tell apart.
#pragma once

#include <cstdint>

#include "drawing/colour.hpp"

namespace palpa::viewer {

using drawing::Colour;
using drawing::mix;
using drawing::rgb;
using drawing::with_alpha;

/// Colours that depend on the background.
struct Theme {
  Colour background, ink, faint_ink, grid, grid_major;
  Colour solid, solid_rim, edge;
  Colour skin, skin_rim, skin_point, dropped_point, loose_contact;
  Colour board, board_edge, idle_transducer, frustum, tile;
};
const Theme& theme_of(bool dark);

/// The axes x, y and z of the world.
inline const Colour axis_colours[] = {rgb(0xd55e00), rgb(0x009e73), rgb(0x0072b2)};

/// Red in the lowest byte, then green, blue and alpha.
std::uint32_t to_pixel(const Colour& colour);

/// The colour of finger `index`; repeats after seven.
Colour finger_colour(std::uint32_t index);

/// The colour of convex part `index`, in place of the whole solid's. Neighbours in the list differ.
Colour part_colour(Colour solid, std::uint32_t index);

/// Hue from the phase (any radians; 0 is red-orange, then through yellow, green and blue), brightness from the
/// amplitude (0..1): equal amplitudes look equally bright at every phase (OKLCH with constant lightness and chroma).
Colour drive_colour(float amplitude, float phase);

}  // namespace palpa::viewer
