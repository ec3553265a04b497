// A picture of values along a line: a curve, on request with a band around it, and axes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "drawing/png.hpp"

namespace palpa::drawing {

struct LinePicture {
  std::span<const double> values;     ///< at equal steps along the line, at least two, never negative
  std::span<const double> low, high;  ///< the band's edges at the same places; both empty: no band
  double length_mm = 0;               ///< of the line, above 0
  std::string along;                  ///< the horizontal axis' name
  std::string title;                  ///< one line
  std::vector<std::string> notes;     ///< below the title, smaller, one line each
  double most = 0;                    ///< the value at the axis' top, in its unit
  double scale = 1;                   ///< from a value to the axis' unit
  std::string unit;                   ///< beside the axis: "Pa", "of the largest"
  const char* along_unit = "mm";      ///< of `along`, if it is not a length: then length_mm is in this unit
};

/// About 1300 pixels wide and 800 high. Where there are more values than pixels, a pixel's column shows the range of
/// its values. A NaN leaves a gap.
Pixels draw(const LinePicture& picture);

}  // namespace palpa::drawing
