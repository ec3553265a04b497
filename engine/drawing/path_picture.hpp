// A picture of a point that moves: its path, coloured by its intensity, and the intensity over time.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "drawing/png.hpp"

namespace palpa::drawing {

struct PathPicture {
  std::span<const Vec2> places_mm;      ///< at equal steps in time, at least one
  std::span<const double> intensities;  ///< 0..1, as many
  double length_s = 0;                  ///< of all steps together, above 0
  std::string title;                    ///< one line
  std::vector<std::string> notes;       ///< below the title, smaller, one line each
};

/// About 840 pixels wide and 1200 high. Silent places are not drawn.
Pixels draw(const PathPicture& picture);

}  // namespace palpa::drawing
