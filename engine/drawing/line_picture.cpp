#include "drawing/line_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "drawing/axes.hpp"
#include "drawing/canvas.hpp"

namespace palpa::drawing {
namespace {

constexpr double wide = 560, tall = 300;  // of the chart, points
const Colour curve_ink = rgb(0x1f5fa8), band_ink = rgb(0xbdd3ea);

/// Least and largest of a range of values.
struct Extent {
  double low = 0, high = 0;
};

/// The curve between the places `from` and `to`, which run from 0 to 1 along the line: its ends, interpolated, and all
/// values between them. nullopt if one of them is no number.
std::optional<Extent> extent(std::span<const double> values, double from, double to) {
  const double last = static_cast<double>(values.size() - 1);
  const auto at = [&](double place) {
    const double index = std::clamp(place, 0.0, 1.0) * last;
    const auto below = static_cast<std::size_t>(index);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (index - static_cast<double>(below));
  };
  const double begin = at(from), end = at(to);
  Extent range{std::min(begin, end), std::max(begin, end)};
  bool all = !std::isnan(begin) && !std::isnan(end);
  for (auto i = static_cast<std::size_t>(std::ceil(std::max(from, 0.0) * last));
       static_cast<double>(i) <= to * last && i < values.size(); ++i) {
    range = {std::min(range.low, values[i]), std::max(range.high, values[i])};
    all = all && !std::isnan(values[i]);
  }
  return all ? std::optional(range) : std::nullopt;
}

}  // namespace

Pixels draw(const LinePicture& picture) {
  const double full = picture.most > 0 ? picture.most : 1;
  const std::uint32_t width = pixels(wide), height = pixels(tall);
  const Marks right = marks(0, picture.length_mm, fitting(width, 0, picture.length_mm));
  const Marks up = marks(0, full, 8);
  const std::uint32_t left = pixels(30 + axis_letters) + up.width();
  const std::uint32_t top = pixels(34 + 15 * static_cast<double>(picture.notes.size()));
  std::uint32_t edge = left + width;
  edge = std::max(edge, pixels(12) + text_pixels(picture.title, axis_letters + 2));
  for (const std::string& note : picture.notes)
    edge = std::max(edge, pixels(12) + text_pixels(note, note_letters));
  Canvas canvas(edge + pixels(20), top + height + pixels(46), picture_paper);

  const auto row = [&](double value) {
    const double part = std::clamp(1 - value * picture.scale / full, 0.0, 1.0);
    return top + static_cast<std::uint32_t>(std::lround(part * (height - 1)));
  };
  std::vector<shader::ViewStroke> strokes;
  Ink ink(picture_ratio, picture_paper, strokes);
  for (std::uint32_t i = 0; i < width; ++i) {
    const double from = (i - 0.5) / (width - 1), to = (i + 0.5) / (width - 1);
    if (!picture.low.empty()) {
      const std::optional<Extent> low = extent(picture.low, from, to), high = extent(picture.high, from, to);
      if (low && high) canvas.fill(left + i, row(high->high), left + i, row(low->low), band_ink);
    }
    if (const std::optional<Extent> curve = extent(picture.values, from, to)) {
      const double x = left + i;
      ink.line({x, row(curve->high)}, {x, row(curve->low)}, 1.4, curve_ink);
    }
  }
  frame(ink, left, top, width, height);
  for (std::size_t i = 0; i < right.at.size(); ++i)
    mark_below(ink, {left + right.at[i] / picture.length_mm * (width - 1), top + height}, right.labels[i]);
  for (std::size_t i = 0; i < up.at.size(); ++i)
    mark_left(ink, {static_cast<double>(left), static_cast<double>(row(up.at[i] / picture.scale))}, up.labels[i]);
  ink.text(picture.along + " (" + picture.along_unit + ")",
           {left + width / 2.0, top + height + ink.px(14 + 2.4 * axis_letters)}, axis_letters, axis_ink, Align::centre);
  ink.text_upwards(picture.unit, {ink.px(13 + axis_letters), top + height / 2.0}, axis_letters, axis_ink);
  head(ink, picture.title, picture.notes);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace palpa::drawing
