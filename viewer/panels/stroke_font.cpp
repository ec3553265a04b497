#include "viewer/panels/stroke_font.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/text.hpp"
#include "drawing/canvas.hpp"
#include "drawing/ink.hpp"

namespace palpa::viewer {
namespace {

/// In points: the height of capitals in a line, and their baseline.
constexpr double capitals = 8.6, baseline = 12.6;

/// The characters that the strokes know besides ASCII: degree, micro, middle dot, times, pi, dash, minus, arrow.
constexpr std::uint32_t others[] = {0xb0, 0xb5, 0xb7, 0xd7, 0x3c0, 0x2013, 0x2212, 0x2192};

struct Glyph {
  int rectangle;  ///< in the atlas
  drawing::Pixels pixels;
};

/// White on black, one pixel wider on each side than the strokes.
drawing::Pixels draw_glyph(const std::string& text, int width, int height, double ratio) {
  std::vector<shader::ViewStroke> strokes;
  drawing::Canvas canvas(static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), drawing::rgb(0));
  drawing::Ink(ratio, drawing::rgb(0), strokes)
      .text(text, {1 + 0.5 * ratio, std::round(baseline * ratio)}, capitals, drawing::rgb(0xffffff),
            drawing::Align::left, 0.92);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace

Glyphs make_stroke_font(ImFontAtlas& atlas, double ratio) {
  atlas.Clear();
  atlas.Flags |= ImFontAtlasFlags_NoMouseCursors | ImFontAtlasFlags_NoBakedLines;
  // ImGui needs a font of its own to add glyphs to: the blank of its built-in font.
  static constexpr ImWchar blank[] = {' ', ' ', 0};
  ImFontConfig config;
  config.SizePixels = static_cast<float>(std::round(text_height * ratio));
  config.GlyphRanges = blank;
  ImFont* font = atlas.AddFontDefault(&config);

  std::vector<std::uint32_t> codes;
  for (std::uint32_t code = ' '; code < 127; ++code)
    codes.push_back(code);
  codes.insert(codes.end(), std::begin(others), std::end(others));
  const int height = static_cast<int>(std::round(text_height * ratio));
  std::vector<Glyph> glyphs;
  for (const std::uint32_t code : codes) {
    const std::string text = utf8(code);
    const double wide = drawing::text_width(text + "|", capitals * ratio) -
                        drawing::text_width("|", capitals * ratio);  // with the gap that follows it
    const auto advance =
        static_cast<float>(std::max(std::ceil(wide), 2.0));  // rounded up, so that letters do not touch
    const int width = static_cast<int>(std::ceil(wide + ratio)) + 2;
    glyphs.push_back({atlas.AddCustomRectFontGlyph(font, static_cast<ImWchar>(code), width, height, advance, {-1, 0}),
                      draw_glyph(text, width, height, ratio)});
  }
  unsigned char* coverage = nullptr;
  int width = 0, rows = 0;
  atlas.GetTexDataAsAlpha8(&coverage, &width, &rows);
  for (const Glyph& glyph : glyphs) {
    const ImFontAtlasCustomRect& place = *atlas.GetCustomRectByIndex(glyph.rectangle);
    for (std::uint32_t y = 0; y < glyph.pixels.height; ++y) {
      for (std::uint32_t x = 0; x < glyph.pixels.width; ++x)
        coverage[(place.Y + y) * static_cast<unsigned>(width) + place.X + x] = glyph.pixels.at(x, y)[0];
    }
  }
  return glyphs_of(atlas);
}

Glyphs glyphs_of(ImFontAtlas& atlas) {
  unsigned char* coverage = nullptr;
  int width = 0, rows = 0;
  atlas.GetTexDataAsAlpha8(&coverage, &width, &rows);
  Glyphs out;
  static std::uint64_t versions = 0;
  out.version = ++versions;
  out.width = static_cast<std::uint32_t>(width);
  out.height = static_cast<std::uint32_t>(rows);
  out.coverage.assign(coverage, coverage + static_cast<std::size_t>(width) * static_cast<std::size_t>(rows));
  return out;
}

}  // namespace palpa::viewer
