// The chart of what skin feels in time: a bar per line of the spectrum, its felt part in the finger's colour.
#pragma once

#include "drawing/ink.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

using drawing::Align;
using drawing::Ink;

/// Draws the chart of `picture.spectra` at the bottom left of a picture of that many pixels. Draws nothing if there are
/// no spectra or no room.
void draw_chart(Ink& ink, const Picture& picture, double width, double height, const Theme& theme);

/// How far up from the picture's lower edge the chart reaches, if fewer than `beside` pixels are left to the right of
/// it; else 0.
double chart_in_the_way(const Picture& picture, double width, double height, double ratio, double beside);

/// The share of the picture's width up to the chart's right edge; 0 if no chart is drawn. `ratio`: pixels per point.
double chart_share(const Picture& picture, double width, double height, double ratio);

/// The smallest 1, 2 or 5 times a power of ten that is at least `most`; 1 if `most` is 0.
double chart_top(double most);

}  // namespace palpa::viewer
