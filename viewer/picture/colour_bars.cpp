#include "viewer/picture/colour_bars.hpp"

#include <algorithm>
#include <string>

#include "drawing/axes.hpp"
#include "viewer/picture/backing.hpp"
#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {
namespace {

constexpr double left_of_all = 112, right_of_all = 210;  // points: axes and scale
constexpr double above_axes = 80, lowest = 34;
constexpr double longest = 300, shortest = 150, step_up = 50;  // points
constexpr double letters = 8, thick = 9;

void draw_bar(drawing::Ink& ink, const ColourBar& bar, const Vec2& at, double length, const Theme& theme) {
  constexpr int pieces = 96;
  const std::string note = note_of(bar), title = note.empty() ? bar.title : bar.title + " (" + note + ")";
  const double wide = std::max(length, drawing::text_width(title, ink.px(letters)));
  const Vec2 middle = at + Vec2(length / 2, 0), half((wide / 2) + ink.px(12), 0);
  draw_backing(ink, middle - half - Vec2(0, ink.px(24)), middle + half + Vec2(0, ink.px(bar.most > 0 ? 25 : -4)),
               theme);
  ink.label(title, at + Vec2(length / 2, -ink.px(10)), letters, theme.ink, drawing::Align::centre);
  if (!(bar.most > 0)) return;
  for (int i = 0; i < pieces; ++i) {
    // Strokes have round ends, so each reaches under the next, and the last ends where the bar does.
    const double from = length * i / pieces, to = std::min(length, length * (i + 1.0) / pieces);
    ink.line(at + Vec2(from, 0), at + Vec2(to, 0), thick, drawing::map_colour((i + 0.5) / pieces));
  }
  const std::vector<double> marks = drawing::ticks(0, bar.most, 5);
  const double step = marks.size() > 1 ? marks[1] - marks[0] : bar.most;
  for (const double mark : marks) {
    const Vec2 foot = at + Vec2(length * mark / bar.most, ink.px(thick / 2));
    ink.line(foot, foot + Vec2(0, ink.px(4)), 1.2, theme.ink);
    ink.label(drawing::tick_label(mark, step), foot + Vec2(0, ink.px(7 + letters)), letters, theme.ink,
              drawing::Align::centre);
  }
}

}  // namespace

double bars_share(const Picture& picture, const Layers& layers, double width, double height, double ratio) {
  constexpr double most = 0.4, above = 30;  // a title with its backing
  const int shown = (layers.shows(Layer::heat) ? 1 : 0) + (layers.shows(Layer::slice) ? 1 : 0);
  if (shown == 0 || picture.transducers.empty() || !layers.shows(Layer::legend)) return 0;
  const bool higher = width < ratio * (left_of_all + right_of_all + shortest);
  const double points = lowest + (higher ? above_axes : 0) + (shown - 1) * step_up + above;
  return std::min(most, ratio * points / std::max(height, 1.0));
}

void draw_bars(drawing::Ink& ink, const Picture& picture, const Layers& layers, double width, double height,
               double chart, const Theme& theme) {
  double left = std::max(ink.px(left_of_all), chart * width + ink.px(24));
  double room = width - ink.px(right_of_all) - left;
  double y = height - ink.px(lowest);
  if (room < ink.px(shortest) && chart == 0) {  // no room between axes and scale, so above them
    left = ink.px(22);
    room = width - 2 * left;
    y -= ink.px(above_axes);
  }
  if (room < ink.px(shortest)) return;
  const double length = std::min(room, ink.px(longest));
  for (const ColourBar& bar : picture.bars) {
    if (!layers.shows(bar.layer)) continue;
    draw_bar(ink, bar, {left + (room - length) / 2, y}, length, theme);
    y -= ink.px(step_up);
  }
}

}  // namespace palpa::viewer
