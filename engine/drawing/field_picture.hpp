// A plane's values as a picture: the map in even colours, axes in millimetres, a bar that says what colours mean.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "drawing/png.hpp"

namespace palpa::drawing {

struct FieldPicture {
  std::span<const double> values;  ///< row by row from the top, none below 0
  std::uint32_t columns = 0, rows = 0;
  Vec2 low_mm{}, high_mm{};        ///< of the plane: its left and bottom, its right and top edge
  std::string right, up;           ///< the axes' names, "x" and "z"
  std::string title;               ///< one line
  std::vector<std::string> notes;  ///< below it, smaller, a line each
  double most = 0;                 ///< what the bar's top stands for, in its unit
  double scale = 1;                ///< a value in the bar's unit
  std::string unit;                ///< above the bar: "Pa", "of the largest"
};

/// About 1000 to 1400 pixels wide and high, more where there are more values. Values between samples are interpolated,
/// where there are more samples than pixels they are averaged; NaN has a colour of its own.
Pixels draw(const FieldPicture& picture);

/// Numbers for an axis from `low` to `high`: multiples of 1, 2 or 5 times a power of ten, `most` of them at most (but
/// two or more wherever there are any).
std::vector<double> ticks(double low, double high, int most);
/// Such a number as text, without needless digits.
std::string tick_label(double value, double step);

}  // namespace palpa::drawing
