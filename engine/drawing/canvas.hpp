// A picture drawn on the host: rectangles, strokes and text on pixels.
#pragma once

#include <cstdint>
#include <span>

#include "base/math.hpp"
#include "drawing/colour.hpp"
#include "drawing/png.hpp"
#include "shaders/viewer/view_scene.h"

namespace palpa::drawing {

class Canvas {
 public:
  Canvas(std::uint32_t width, std::uint32_t height, const Colour& paper);

  /// Whole pixels from the top left; what lies outside of the picture is left out.
  void set(std::uint32_t x, std::uint32_t y, const Colour& colour);
  /// Strokes in pixels, as Ink makes them, the later over the earlier; with smooth edges and round ends.
  void draw(std::span<const shader::ViewStroke> strokes);
  /// A rectangle of whole pixels, both corners included.
  void fill(std::uint32_t left, std::uint32_t top, std::uint32_t right, std::uint32_t bottom, const Colour& colour);

  const Pixels& pixels() const { return pixels_; }

 private:
  void blend(std::uint32_t x, std::uint32_t y, const Colour& colour, double part);

  Pixels pixels_;
};

}  // namespace palpa::drawing
