#include "drawing/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpa::drawing {

std::uint32_t pixels(double points) {
  return static_cast<std::uint32_t>(std::lround(points * picture_ratio));
}

std::uint32_t text_pixels(std::string_view text, double height) {
  return static_cast<std::uint32_t>(std::ceil(text_width(text, height * picture_ratio)));
}

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

std::uint32_t Marks::width() const {
  std::uint32_t widest = 0;
  for (const std::string& label : labels)
    widest = std::max(widest, text_pixels(label, axis_letters));
  return widest;
}

Marks marks(double low, double high, int most) {
  Marks marks;
  marks.at = ticks(low, high, most);
  const double step = marks.at.size() > 1 ? marks.at[1] - marks.at[0] : 1;
  for (const double value : marks.at)
    marks.labels.push_back(tick_label(value, step));
  return marks;
}

int fitting(double room, double low, double high) {
  const double widest = std::max(text_pixels(tick_label(std::floor(low), 0.1), axis_letters),
                                 text_pixels(tick_label(std::ceil(high), 0.1), axis_letters));
  return std::clamp(static_cast<int>(room / (widest + pixels(16))), 2, 10);
}

void frame(Ink& ink, double left, double top, double width, double height) {
  const Vec2 a(left, top), b(left + width, top), c(left + width, top + height), d(left, top + height);
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)})
    ink.line(from, to, 0.8, axis_ink);
}

void mark_below(Ink& ink, const Vec2& foot, std::string_view label) {
  ink.line(foot, foot + Vec2(0, ink.px(4)), 0.8, axis_ink);
  ink.text(label, foot + Vec2(0, ink.px(8 + axis_letters)), axis_letters, axis_ink, Align::centre);
}

void mark_left(Ink& ink, const Vec2& foot, std::string_view label) {
  ink.line(foot, foot - Vec2(ink.px(4), 0), 0.8, axis_ink);
  ink.text(label, foot + Vec2(-ink.px(8), ink.px(axis_letters / 2)), axis_letters, axis_ink, Align::right);
}

void head(Ink& ink, std::string_view title, const std::vector<std::string>& notes) {
  ink.text(title, {ink.px(12), ink.px(21)}, axis_letters + 2, axis_ink);
  for (std::size_t i = 0; i < notes.size(); ++i)
    ink.text(notes[i], {ink.px(12), ink.px(38 + 15 * static_cast<double>(i))}, note_letters, note_ink);
}

}  // namespace palpa::drawing
