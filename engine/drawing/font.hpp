// Text as strokes: a small sans-serif drawn with lines and arcs, sharp at every size, with no font file to be missing.
#pragma once

#include <string_view>
#include <vector>

#include "base/math.hpp"

namespace palpa::drawing {

/// A line of the pen, in pixels, y down. Both ends are equal for a dot.
struct PenStroke {
  Vec2 from, to;
};

/// Width of `text` when capitals are `height` pixels high. UTF-8; what the font does not have is a small box.
double text_width(std::string_view text, double height);

/// Appends the strokes of `text`, its baseline beginning at `origin`.
void write_text(std::string_view text, const Vec2& origin, double height, std::vector<PenStroke>& out);

}  // namespace palpa::drawing
