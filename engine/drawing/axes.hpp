// The parts that pictures with axes share: colours, ticks and their labels, a frame.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "drawing/colour.hpp"
#include "drawing/ink.hpp"

namespace palpa::drawing {

inline constexpr double picture_ratio = 2;                     ///< pixels per point
inline constexpr double axis_letters = 9, note_letters = 7.5;  ///< height of capitals, points
inline const Colour picture_paper = rgb(0xffffff), axis_ink = rgb(0x1f2933), note_ink = rgb(0x66727f);

std::uint32_t pixels(double points);
/// The width of text with letters of this height.
std::uint32_t text_pixels(std::string_view text, double height);

/// Tick positions for an axis from `low` to `high`: multiples of 1, 2 or 5 times a power of ten, at most `most` of them
/// (but at least two where they exist).
std::vector<double> ticks(double low, double high, int most);
/// A tick's number as text, without unnecessary digits.
std::string tick_label(double value, double step);

/// The ticks of an axis, with their labels.
struct Marks {
  std::vector<double> at;
  std::vector<std::string> labels;

  /// The width of the widest label.
  std::uint32_t width() const;
};
Marks marks(double low, double high, int most);
/// How many labels of an axis from `low` to `high` fit side by side into `room` pixels, with gaps.
int fitting(double room, double low, double high);

/// The outline of a rectangle, in pixels.
void frame(Ink& ink, double left, double top, double width, double height);
/// An axis' mark and label below the bottom of a frame, and at its left side.
void mark_below(Ink& ink, const Vec2& foot, std::string_view label);
void mark_left(Ink& ink, const Vec2& foot, std::string_view label);
/// The title at the top, and the notes below it, one line each.
void head(Ink& ink, std::string_view title, const std::vector<std::string>& notes);

}  // namespace palpa::drawing
