// A TrueType font of the system as a font of Dear ImGui: that of the panels, in a window or without one. Without such a
// font, panels have palpa's own strokes, as all other text of a picture has.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "viewer/picture/sheet.hpp"

struct ImFontAtlas;

namespace palpa::viewer {

/// The bytes of a sans-serif font: one of those that distributions have, else the one of fontconfig_file(). Empty if
/// there is no font. The usual places come first, because fontconfig may take seconds before it has a cache.
std::string system_font();
/// The TrueType font that fontconfig takes for "sans". Empty if there is no fontconfig, or if it knows no font.
std::string fontconfig_file();

/// The sizes of make_file_font's fonts, relative to the panels' text: that text comes first.
inline constexpr std::array<double, 3> font_scales{1, 1.2, 1.6};

/// Replaces the fonts of `atlas` by this one in all font_scales, for `ratio` pixels per point. Returns its pixels;
/// nullopt if the bytes are no TrueType font.
std::optional<Glyphs> make_file_font(ImFontAtlas& atlas, std::string& ttf, double ratio);

}  // namespace palpa::viewer
