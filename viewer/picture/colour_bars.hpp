// The bars at the bottom of a picture that explain the colours of a field.
#pragma once

#include "drawing/ink.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/view/view_state.hpp"

namespace palpa::viewer {

/// Draws the bars of the layers that are shown, one above the other, between the axes or the chart and the scale of a
/// picture of that many pixels. `chart`: the share of the width up to the chart's right edge, 0 without a chart. Draws
/// nothing if there is no room.
void draw_bars(drawing::Ink& ink, const Picture& picture, const Layers& layers, double width, double height,
               double chart, const Theme& theme);

/// The share of the picture's height, counted from below, that the bars of an array's sound take once they are there; 0
/// if no layer with a bar is shown, or if there is no array. `ratio`: pixels per point.
double bars_share(const Picture& picture, const Layers& layers, double width, double height, double ratio);

}  // namespace palpa::viewer
