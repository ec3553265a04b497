// The bars that say what the colours of a field mean, at the bottom of a picture.
#pragma once

#include "drawing/ink.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// Draws the bars of the layers that are shown, one above the other, between axes or chart and the scale of a picture
/// of so many pixels. `chart`: the share of the width up to the chart's right edge, 0 without one. Nothing where there
/// is no room.
void draw_bars(drawing::Ink& ink, const Picture& picture, const Layers& layers, double width, double height,
               double chart, const Theme& theme);

}  // namespace palpa::viewer
