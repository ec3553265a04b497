// What lies flat on a whole picture, over all of its views: coloured triangles, and glyphs from an atlas. These are
// plain values; the sheet does not know what they mean.
#pragma once

#include <cstdint>
#include <vector>

#include "shaders/viewer/view_sheet.h"

namespace palpa::viewer {

/// Glyphs side by side, each texel its coverage 0..255, rows from the top.
struct Glyphs {
  std::uint32_t width = 0, height = 0;  ///< the width is a multiple of 4
  std::vector<std::uint8_t> coverage;
  std::uint64_t version = 0;  ///< changes whenever the glyphs change
};

/// Triangles that are clipped to one rectangle of the picture.
struct SheetRun {
  std::int32_t left = 0, top = 0;  ///< pixels, inside the picture
  std::uint32_t width = 0, height = 0;
  std::uint32_t first = 0, count = 0;  ///< corners
};

struct Sheet {
  std::vector<shader::SheetCorner> corners;
  std::vector<SheetRun> runs;  ///< later ones lie over earlier ones
  const Glyphs* glyphs = nullptr;
};

}  // namespace palpa::viewer
