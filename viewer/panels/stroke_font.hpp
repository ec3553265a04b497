// palpa's own pen strokes as a font of Dear ImGui: sharp at every size, and without a file that can be missing or
// broken.
#pragma once

#include "viewer/picture/sheet.hpp"

struct ImFontAtlas;

namespace palpa::viewer {

/// The height of a line of text, in points.
inline constexpr double text_height = 17;

/// Replaces the font of `atlas` by one for `ratio` pixels per point. Returns its pixels.
Glyphs make_stroke_font(ImFontAtlas& atlas, double ratio);

/// The pixels of the font that `atlas` has.
Glyphs glyphs_of(ImFontAtlas& atlas);

}  // namespace palpa::viewer
