// palpa's own pen strokes as a font of Dear ImGui: sharp at every size, and no file of it can be missing or broken.
#pragma once

#include "viewer/picture/sheet.hpp"

struct ImFontAtlas;

namespace palpa::viewer {

/// Of a line of text, points.
inline constexpr double text_height = 17;

/// Makes the font of `atlas` anew for `ratio` pixels per point, and its pixels.
Glyphs make_stroke_font(ImFontAtlas& atlas, double ratio);

}  // namespace palpa::viewer
