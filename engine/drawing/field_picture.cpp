#include "drawing/field_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "drawing/axes.hpp"
#include "drawing/canvas.hpp"
#include "drawing/colour.hpp"
#include "drawing/font.hpp"
#include "drawing/ink.hpp"

namespace palpa::drawing {
namespace {

constexpr double longest = 960, largest = 4096;  // of the map, pixels

/// The positions of the elements, in pixels.
struct Sheet {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;  // of the map
  std::uint32_t bar_left = 0, bar_width = 0, bar_top = 0, bar_height = 0;
  std::uint32_t all_width = 0, all_height = 0;
};

Sheet sheet_for(const FieldPicture& picture, const Marks& up, const Marks& bar) {
  const Vec2 size = picture.high_mm - picture.low_mm;
  const double side = std::clamp<double>(std::max(picture.columns, picture.rows), longest, largest);
  const double scale = side / std::max(size.x, size.y);
  Sheet sheet;
  sheet.width = std::max(1U, static_cast<std::uint32_t>(std::lround(size.x * scale)));
  sheet.height = std::max(1U, static_cast<std::uint32_t>(std::lround(size.y * scale)));
  sheet.left = pixels(30 + axis_letters) + up.width();
  sheet.top = pixels(34 + 15 * static_cast<double>(picture.notes.size()));
  sheet.bar_left = sheet.left + sheet.width + pixels(24);
  sheet.bar_width = pixels(13);
  sheet.bar_top = sheet.top + pixels(20);  // below its unit
  // The bar is always long enough for its labels, however flat the map is.
  sheet.bar_height = std::max(sheet.height, pixels(110)) - pixels(20);
  std::uint32_t right =
      sheet.bar_left + std::max(sheet.bar_width + pixels(10) + bar.width(), text_pixels(picture.unit, axis_letters));
  right = std::max(right, pixels(12) + text_pixels(picture.title, axis_letters + 2));
  for (const std::string& note : picture.notes)
    right = std::max(right, pixels(12) + text_pixels(note, note_letters));
  sheet.all_width = right + pixels(14);
  sheet.all_height = std::max(sheet.top + sheet.height + pixels(46), sheet.bar_top + sheet.bar_height + pixels(14));
  return sheet;
}

/// The picture's value for one pixel of its map. `x` and `y` run from 0 to 1 from the top left, in steps of (dx, dy).
class Sampler {
 public:
  explicit Sampler(const FieldPicture& picture) : picture_(picture) {}

  double at(double x, double y, double dx, double dy) const {
    const double columns = picture_.columns, rows = picture_.rows;
    if (dx * columns > 1 || dy * rows > 1) return mean(x * columns, (x + dx) * columns, y * rows, (y + dy) * rows);
    return between((x + dx / 2) * columns - 0.5, (y + dy / 2) * rows - 0.5);
  }

 private:
  double value(double column, double row) const {
    const auto c = static_cast<std::size_t>(std::clamp(column, 0.0, picture_.columns - 1.0));
    const auto r = static_cast<std::size_t>(std::clamp(row, 0.0, picture_.rows - 1.0));
    return picture_.values[r * picture_.columns + c];
  }
  double between(double column, double row) const {
    const double c = std::floor(column), r = std::floor(row), s = column - c, t = row - r;
    const double above = value(c, r) * (1 - s) + value(c + 1, r) * s;
    const double below = value(c, r + 1) * (1 - s) + value(c + 1, r + 1) * s;
    return above * (1 - t) + below * t;
  }
  double mean(double left, double right, double top, double bottom) const {
    double sum = 0, count = 0;
    for (double row = std::floor(top); row < std::max(bottom, std::floor(top) + 1); ++row) {
      for (double column = std::floor(left); column < std::max(right, std::floor(left) + 1); ++column) {
        sum += value(column, row);
        ++count;
      }
    }
    return sum / count;
  }

  const FieldPicture& picture_;
};

void draw_map(Canvas& canvas, const Sheet& sheet, const FieldPicture& picture) {
  const Sampler sampler(picture);
  const double dx = 1.0 / sheet.width, dy = 1.0 / sheet.height, full = picture.most > 0 ? picture.most : 1;
  for (std::uint32_t j = 0; j < sheet.height; ++j) {
    for (std::uint32_t i = 0; i < sheet.width; ++i)
      canvas.set(sheet.left + i, sheet.top + j, map_colour(sampler.at(i * dx, j * dy, dx, dy) * picture.scale / full));
  }
}

void draw_bar(Canvas& canvas, const Sheet& sheet) {
  for (std::uint32_t j = 0; j < sheet.bar_height; ++j) {
    const double value = 1 - (j + 0.5) / sheet.bar_height;
    canvas.fill(sheet.bar_left, sheet.bar_top + j, sheet.bar_left + sheet.bar_width - 1, sheet.bar_top + j,
                map_colour(value));
  }
}

}  // namespace

Pixels draw(const FieldPicture& picture) {
  const Vec2 size = picture.high_mm - picture.low_mm;
  const double scale = longest / std::max(size.x, size.y);
  const Marks right =
      marks(picture.low_mm.x, picture.high_mm.x, fitting(size.x * scale, picture.low_mm.x, picture.high_mm.x));
  const Marks up =
      marks(picture.low_mm.y, picture.high_mm.y, std::clamp(static_cast<int>(size.y * scale / pixels(17)), 2, 10));
  const Marks bar = marks(0, picture.most, 6);
  const Sheet sheet = sheet_for(picture, up, bar);
  Canvas canvas(sheet.all_width, sheet.all_height, picture_paper);
  draw_map(canvas, sheet, picture);
  draw_bar(canvas, sheet);

  std::vector<shader::ViewStroke> strokes;
  Ink ink(picture_ratio, picture_paper, strokes);
  const double left = sheet.left, top = sheet.top, width = sheet.width, height = sheet.height;
  frame(ink, left, top, width, height);
  frame(ink, sheet.bar_left, sheet.bar_top, sheet.bar_width, sheet.bar_height);
  for (std::size_t i = 0; i < right.at.size(); ++i)
    mark_below(ink, {left + (right.at[i] - picture.low_mm.x) / size.x * width, top + height}, right.labels[i]);
  for (std::size_t i = 0; i < up.at.size(); ++i)
    mark_left(ink, {left, top + (picture.high_mm.y - up.at[i]) / size.y * height}, up.labels[i]);
  for (std::size_t i = 0; i < bar.at.size(); ++i) {
    const Vec2 foot(sheet.bar_left + sheet.bar_width,
                    sheet.bar_top + (1 - bar.at[i] / picture.most) * sheet.bar_height);
    ink.line(foot, foot + Vec2(ink.px(4), 0), 0.8, axis_ink);
    ink.text(bar.labels[i], foot + Vec2(ink.px(8), ink.px(axis_letters / 2)), axis_letters, axis_ink);
  }
  ink.text(picture.right + " (mm)", {left + width / 2, top + height + ink.px(14 + 2.4 * axis_letters)}, axis_letters,
           axis_ink, Align::centre);
  ink.text_upwards(picture.up + " (mm)", {ink.px(13 + axis_letters), top + height / 2}, axis_letters, axis_ink);
  ink.text(picture.unit, {static_cast<double>(sheet.bar_left), top + ink.px(axis_letters - 1)}, axis_letters, axis_ink);
  head(ink, picture.title, picture.notes);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace palpa::drawing
