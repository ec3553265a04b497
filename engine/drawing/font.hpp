// Text as strokes: a small sans-serif font of lines and arcs, sharp at every size, that needs no font file.
#pragma once

#include <string_view>
#include <vector>

#include "base/math.hpp"

namespace palpa::drawing {

/// One pen stroke, in pixels, y down. For a dot, both ends are equal.
struct PenStroke {
  Vec2 from, to;
};

/// Width of `text` if capitals are `height` pixels high. UTF-8. The font has the letters of Western European
/// languages; characters that it lacks are drawn as a small box.
double text_width(std::string_view text, double height);

/// Appends the strokes of `text`. Its baseline begins at `origin`.
void write_text(std::string_view text, const Vec2& origin, double height, std::vector<PenStroke>& out);

}  // namespace palpa::drawing
