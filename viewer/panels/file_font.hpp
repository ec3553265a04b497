// A TrueType font of the system as a font of Dear ImGui, for windows. Pictures without a window keep palpa's own
// strokes, so that they look the same everywhere.
#pragma once

#include <optional>
#include <string>

#include "viewer/picture/sheet.hpp"

struct ImFontAtlas;

namespace palpa::viewer {

/// The bytes of a sans-serif font that the system has at one of the usual places; empty if it has none.
std::string system_font();

/// Replaces the font of `atlas` by this one, for `ratio` pixels per point. Returns its pixels; nullopt if the bytes are
/// no TrueType font.
std::optional<Glyphs> make_file_font(ImFontAtlas& atlas, std::string& ttf, double ratio);

}  // namespace palpa::viewer
