// A backing behind text, so that the picture does not show through clearly and the text can be read.
#pragma once

#include <algorithm>
#include <cmath>

#include "drawing/ink.hpp"
#include "viewer/picture/palette.hpp"

namespace palpa::viewer {

/// Covers the rectangle with the background, so that little shows through. It consists of many thin strokes: strokes
/// have round ends, and with thin ones the corners are hardly rounded. The strokes are whole pixels high, so that they
/// meet without overlapping.
inline void draw_backing(drawing::Ink& ink, const Vec2& low, const Vec2& high, const Theme& theme) {
  constexpr double opacity = 0.8;
  const double row = std::max(std::round(ink.px(2)), 1.0);
  for (double y = std::floor(low.y) + row / 2; y < high.y; y += row)
    ink.line({low.x, y}, {high.x, y}, row / ink.px(1), with_alpha(theme.background, opacity));
}

}  // namespace palpa::viewer
