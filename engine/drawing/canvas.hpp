// A picture drawn on the host: rectangles, strokes and text as pixels.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

#include "base/math.hpp"
#include "drawing/colour.hpp"
#include "drawing/png.hpp"
#include "shaders/viewer/view_scene.h"

namespace palpa::drawing {

class Canvas {
 public:
  Canvas(std::uint32_t width, std::uint32_t height, const Colour& paper);
  /// Goes on with that picture.
  explicit Canvas(Pixels picture) : pixels_(std::move(picture)) {}

  /// Sets one pixel, counted from the top left. Pixels outside the picture are ignored.
  void set(std::uint32_t x, std::uint32_t y, const Colour& colour);
  /// Draws strokes in pixels, as Ink makes them, with smooth edges and round ends. Later strokes cover earlier ones.
  void draw(std::span<const shader::ViewStroke> strokes);
  /// Fills a rectangle of whole pixels, both corners included.
  void fill(std::uint32_t left, std::uint32_t top, std::uint32_t right, std::uint32_t bottom, const Colour& colour);

  const Pixels& pixels() const { return pixels_; }

 private:
  void blend(std::uint32_t x, std::uint32_t y, const Colour& colour, double part);

  Pixels pixels_;
};

}  // namespace palpa::drawing
