#include "drawing/field_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "drawing/canvas.hpp"
#include "drawing/colour.hpp"
#include "drawing/font.hpp"
#include "drawing/ink.hpp"

namespace palpa::drawing {
namespace {

constexpr double ratio = 2;                         // pixels per point
constexpr double longest = 960, largest = 4096;     // of the map, pixels
constexpr double letters = 9, small_letters = 7.5;  // height of capitals, points
const Colour paper = rgb(0xffffff), ink_colour = rgb(0x1f2933), faint = rgb(0x66727f);

/// The positions of the elements, in pixels.
struct Sheet {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;  // of the map
  std::uint32_t bar_left = 0, bar_width = 0, bar_top = 0, bar_height = 0;
  std::uint32_t all_width = 0, all_height = 0;
};

std::uint32_t pixels(double points) {
  return static_cast<std::uint32_t>(std::lround(points * ratio));
}
std::uint32_t text_pixels(std::string_view text, double height) {
  return static_cast<std::uint32_t>(std::ceil(text_width(text, height * ratio)));
}

Sheet sheet_for(const FieldPicture& picture, const std::vector<std::string>& up_labels,
                const std::vector<std::string>& bar_labels) {
  const Vec2 size = picture.high_mm - picture.low_mm;
  const double side = std::clamp<double>(std::max(picture.columns, picture.rows), longest, largest);
  const double scale = side / std::max(size.x, size.y);
  Sheet sheet;
  sheet.width = std::max(1U, static_cast<std::uint32_t>(std::lround(size.x * scale)));
  sheet.height = std::max(1U, static_cast<std::uint32_t>(std::lround(size.y * scale)));
  const auto widest = [](const std::vector<std::string>& labels) {
    std::uint32_t width = 0;
    for (const std::string& label : labels)
      width = std::max(width, text_pixels(label, letters));
    return width;
  };
  sheet.left = pixels(30 + letters) + widest(up_labels);
  sheet.top = pixels(34 + 15 * static_cast<double>(picture.notes.size()));
  sheet.bar_left = sheet.left + sheet.width + pixels(24);
  sheet.bar_width = pixels(13);
  sheet.bar_top = sheet.top + pixels(20);  // below its unit
  // The bar is always long enough for its labels, however flat the map is.
  sheet.bar_height = std::max(sheet.height, pixels(110)) - pixels(20);
  std::uint32_t right =
      sheet.bar_left + std::max(sheet.bar_width + pixels(10) + widest(bar_labels), text_pixels(picture.unit, letters));
  right = std::max(right, pixels(12) + text_pixels(picture.title, letters + 2));
  for (const std::string& note : picture.notes)
    right = std::max(right, pixels(12) + text_pixels(note, small_letters));
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

void frame(Ink& ink, double left, double top, double width, double height) {
  const Vec2 a(left, top), b(left + width, top), c(left + width, top + height), d(left, top + height);
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)})
    ink.line(from, to, 0.8, ink_colour);
}

struct Marks {
  std::vector<double> at;
  std::vector<std::string> labels;
};
Marks marks(double low, double high, int most) {
  Marks marks;
  marks.at = ticks(low, high, most);
  const double step = marks.at.size() > 1 ? marks.at[1] - marks.at[0] : 1;
  for (const double value : marks.at)
    marks.labels.push_back(tick_label(value, step));
  return marks;
}

/// How many numbers fit side by side, each as wide as the wider end plus a gap.
int fitting(double room, double low, double high) {
  const double widest = std::max(text_pixels(tick_label(std::floor(low), 0.1), letters),
                                 text_pixels(tick_label(std::ceil(high), 0.1), letters));
  return std::clamp(static_cast<int>(room / (widest + pixels(16))), 2, 10);
}

}  // namespace

std::vector<double> ticks(double low, double high, int most) {
  std::vector<double> all;
  if (!(high > low) || !std::isfinite(high - low)) return all;
  double step = std::pow(10.0, std::floor(std::log10((high - low) / std::max(most, 1))));
  for (int i = 0; std::floor(high / step + 1e-9) - std::ceil(low / step - 1e-9) + 1 > std::max(most, 2) && i < 20; ++i)
    step *= i % 3 == 1 ? 2.5 : 2;
  for (double n = std::ceil(low / step - 1e-9); n <= std::floor(high / step + 1e-9); ++n)
    all.push_back(n * step);
  return all;
}

std::string tick_label(double value, double step) {
  const int digits = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  std::string text = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool nothing = text.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !nothing ? "\u2212" + text : text;
}

Pixels draw(const FieldPicture& picture) {
  const Vec2 size = picture.high_mm - picture.low_mm;
  const double scale = longest / std::max(size.x, size.y);
  const Marks right =
      marks(picture.low_mm.x, picture.high_mm.x, fitting(size.x * scale, picture.low_mm.x, picture.high_mm.x));
  const Marks up =
      marks(picture.low_mm.y, picture.high_mm.y, std::clamp(static_cast<int>(size.y * scale / pixels(17)), 2, 10));
  const Marks bar = marks(0, picture.most, 6);
  const Sheet sheet = sheet_for(picture, up.labels, bar.labels);
  Canvas canvas(sheet.all_width, sheet.all_height, paper);
  draw_map(canvas, sheet, picture);
  draw_bar(canvas, sheet);

  std::vector<shader::ViewStroke> strokes;
  Ink ink(ratio, paper, strokes);
  const double left = sheet.left, top = sheet.top, width = sheet.width, height = sheet.height;
  frame(ink, left, top, width, height);
  frame(ink, sheet.bar_left, sheet.bar_top, sheet.bar_width, sheet.bar_height);
  const double half = letters / 2;
  for (std::size_t i = 0; i < right.at.size(); ++i) {
    const Vec2 foot(left + (right.at[i] - picture.low_mm.x) / size.x * width, top + height);
    ink.line(foot, foot + Vec2(0, ink.px(4)), 0.8, ink_colour);
    ink.text(right.labels[i], foot + Vec2(0, ink.px(8 + letters)), letters, ink_colour, Align::centre);
  }
  for (std::size_t i = 0; i < up.at.size(); ++i) {
    const Vec2 foot(left, top + (picture.high_mm.y - up.at[i]) / size.y * height);
    ink.line(foot, foot - Vec2(ink.px(4), 0), 0.8, ink_colour);
    ink.text(up.labels[i], foot + Vec2(-ink.px(8), ink.px(half)), letters, ink_colour, Align::right);
  }
  for (std::size_t i = 0; i < bar.at.size(); ++i) {
    const Vec2 foot(sheet.bar_left + sheet.bar_width,
                    sheet.bar_top + (1 - bar.at[i] / picture.most) * sheet.bar_height);
    ink.line(foot, foot + Vec2(ink.px(4), 0), 0.8, ink_colour);
    ink.text(bar.labels[i], foot + Vec2(ink.px(8), ink.px(half)), letters, ink_colour);
  }
  ink.text(picture.right + " (mm)", {left + width / 2, top + height + ink.px(14 + 2.4 * letters)}, letters, ink_colour,
           Align::centre);
  ink.text_upwards(picture.up + " (mm)", {ink.px(13 + letters), top + height / 2}, letters, ink_colour);
  ink.text(picture.unit, {static_cast<double>(sheet.bar_left), top + ink.px(letters - 1)}, letters, ink_colour);
  ink.text(picture.title, {ink.px(12), ink.px(21)}, letters + 2, ink_colour);
  for (std::size_t i = 0; i < picture.notes.size(); ++i)
    ink.text(picture.notes[i], {ink.px(12), ink.px(38 + 15 * static_cast<double>(i))}, small_letters, faint);
  canvas.draw(strokes);
  return canvas.pixels();
}

}  // namespace palpa::drawing
