// A picture of a plane's values: a map in uniform colours, axes in millimetres, and a colour bar.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "drawing/png.hpp"

namespace palpa::drawing {

struct FieldPicture {
  std::span<const double> values;  ///< row by row from the top, never negative
  std::uint32_t columns = 0, rows = 0;
  Vec2 low_mm{}, high_mm{};        ///< the plane's left and bottom, right and top edges
  std::string right, up;           ///< the axes' names, "x" and "z"
  std::string title;               ///< one line
  std::vector<std::string> notes;  ///< below the picture, smaller, one line each
  double most = 0;                 ///< the value at the bar's top, in its unit
  double scale = 1;                ///< from a value to the bar's unit
  std::string unit;                ///< above the bar: "Pa", "of the largest"
};

/// About 1000 to 1400 pixels wide and high, larger if there are more values. Values are interpolated between samples,
/// and averaged if there are more samples than pixels. NaN has its own colour.
Pixels draw(const FieldPicture& picture);

}  // namespace palpa::drawing
