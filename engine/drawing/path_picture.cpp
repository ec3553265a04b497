#include "drawing/path_picture.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "drawing/axes.hpp"
#include "drawing/canvas.hpp"

namespace palpa::drawing {
namespace {

constexpr double wide = 340, tall = 340, chart_tall = 110;  // points

/// Silence is the paper's colour, and the loudest is dark.
Colour ink_of(double intensity) {
  return map_colour(0.85 * (1 - intensity));
}

/// The square around all places that sound, or around all if none does.
Box square_around(const PathPicture& picture) {
  Box box;
  for (const bool all : {false, true}) {
    for (std::size_t i = 0; i < picture.places_mm.size() && (box.empty() || !all); ++i) {
      if (all || picture.intensities[i] > 0) box.add(Vec3(picture.places_mm[i], 0));
    }
  }
  constexpr double least_mm = 5, margin = 1.15;
  const Vec3 middle = box.centre(), extent = box.high - box.low;
  const double half = std::max(least_mm, margin * std::max(extent.x, extent.y) / 2);
  box.low = middle - Vec3(half, half, 0);
  box.high = middle + Vec3(half, half, 0);
  return box;
}

void draw_path(Ink& ink, const PathPicture& picture, const Vec2& corner, const Vec2& size) {
  const Box box = square_around(picture);
  const double span = box.high.x - box.low.x;
  const auto at = [&](const Vec2& mm) {
    return corner + Vec2((mm.x - box.low.x) / span * size.x, (box.high.y - mm.y) / span * size.y);
  };
  for (std::size_t i = 0; i < picture.places_mm.size(); ++i) {
    const double now = picture.intensities[i];
    if (!(now > 0)) continue;
    ink.disc(at(picture.places_mm[i]), 1.1, ink_of(now));
    if (i > 0 && picture.intensities[i - 1] > 0)
      ink.line(at(picture.places_mm[i - 1]), at(picture.places_mm[i]), 0.8, ink_of(now));
  }
  frame(ink, corner.x, corner.y, size.x, size.y);
  const Marks right = marks(box.low.x, box.high.x, fitting(size.x, box.low.x, box.high.x));
  const Marks up = marks(box.low.y, box.high.y, 8);
  for (std::size_t i = 0; i < right.at.size(); ++i)
    mark_below(ink, {at({right.at[i], 0}).x, corner.y + size.y}, right.labels[i]);
  for (std::size_t i = 0; i < up.at.size(); ++i)
    mark_left(ink, {corner.x, at({0, up.at[i]}).y}, up.labels[i]);
  ink.text("x (mm)", {corner.x + size.x / 2, corner.y + size.y + ink.px(14 + 2.4 * axis_letters)}, axis_letters,
           axis_ink, Align::centre);
  ink.text_upwards("y (mm)", {ink.px(13 + axis_letters), corner.y + size.y / 2}, axis_letters, axis_ink);
}

/// A column of pixels shows the range of the intensities in its time.
void draw_chart(Ink& ink, const PathPicture& picture, const Vec2& corner, const Vec2& size) {
  const auto count = static_cast<double>(picture.intensities.size());
  const auto row = [&](double intensity) { return corner.y + (1 - intensity) * (size.y - 1); };
  const auto columns = static_cast<std::uint32_t>(size.x);
  for (std::uint32_t column = 0; column < columns; ++column) {
    const auto from = static_cast<std::size_t>(count * column / columns);
    const auto to = std::max(from + 1, static_cast<std::size_t>(count * (column + 1) / columns));
    // From the last one before, so that a step is a line.
    const std::size_t before = from > 0 ? from - 1 : 0;
    const auto [low, high] = std::ranges::minmax(picture.intensities.subspan(before, to - before));
    const double x = corner.x + column;
    ink.line({x, row(high)}, {x, row(low)}, 1.2, ink_of(high));
  }
  frame(ink, corner.x, corner.y, size.x, size.y);
  const Marks right = marks(0, picture.length_s, fitting(size.x, 0, picture.length_s));
  for (std::size_t i = 0; i < right.at.size(); ++i)
    mark_below(ink, {corner.x + right.at[i] / picture.length_s * size.x, corner.y + size.y}, right.labels[i]);
  for (const double intensity : {0.0, 0.5, 1.0})
    mark_left(ink, {corner.x, row(intensity)}, tick_label(intensity, 0.5));
  ink.text("time (s)", {corner.x + size.x / 2, corner.y + size.y + ink.px(14 + 2.4 * axis_letters)}, axis_letters,
           axis_ink, Align::centre);
  ink.text_upwards("intensity", {ink.px(13 + axis_letters), corner.y + size.y / 2}, axis_letters, axis_ink);
}

}  // namespace

Pixels draw(const PathPicture& picture) {
  const Vec2 path(pixels(wide), pixels(tall)), chart(pixels(wide), pixels(chart_tall));
  const double left = pixels(30 + axis_letters) + text_pixels("-100.5", axis_letters);
  const double top = pixels(34 + 15 * static_cast<double>(picture.notes.size()));
  const double below = top + path.y + pixels(52);
  double edge = left + path.x;
  edge = std::max<double>(edge, pixels(12) + text_pixels(picture.title, axis_letters + 2));
  for (const std::string& note : picture.notes)
    edge = std::max<double>(edge, pixels(12) + text_pixels(note, note_letters));
  Canvas canvas(static_cast<std::uint32_t>(edge) + pixels(20), static_cast<std::uint32_t>(below + chart.y) + pixels(46),
                picture_paper);
  std::vector<shader::ViewStroke> strokes;
  Ink ink(picture_ratio, picture_paper, strokes);
  draw_path(ink, picture, {left, top}, path);
  draw_chart(ink, picture, {left, below}, chart);
  head(ink, picture.title, picture.notes);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace palpa::drawing
