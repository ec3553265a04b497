#include "drawing/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

namespace palpa::drawing {
namespace {

std::uint8_t byte(float part) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0f, 1.0f) * 255));
}

double distance_to(const Vec2& from, const Vec2& to, const Vec2& point) {
  const Vec2 along = to - from;
  const double square = glm::dot(along, along);
  const double t = square > 0 ? std::clamp(glm::dot(point - from, along) / square, 0.0, 1.0) : 0.0;
  return glm::length(point - from - along * t);
}

}  // namespace

Canvas::Canvas(std::uint32_t width, std::uint32_t height, const Colour& paper) {
  pixels_.width = width;
  pixels_.height = height;
  pixels_.rgba.resize(std::size_t{4} * width * height);
  if (width > 0 && height > 0) fill(0, 0, width - 1, height - 1, paper);
}

void Canvas::set(std::uint32_t x, std::uint32_t y, const Colour& colour) {
  if (x >= pixels_.width || y >= pixels_.height) return;
  std::uint8_t* const at = &pixels_.rgba[4 * (std::size_t{y} * pixels_.width + x)];
  at[0] = byte(colour.r);
  at[1] = byte(colour.g);
  at[2] = byte(colour.b);
  at[3] = 255;
}

void Canvas::fill(std::uint32_t left, std::uint32_t top, std::uint32_t right, std::uint32_t bottom,
                  const Colour& colour) {
  for (std::uint32_t y = top; y <= bottom; ++y) {
    for (std::uint32_t x = left; x <= right; ++x)
      set(x, y, colour);
  }
}

void Canvas::blend(std::uint32_t x, std::uint32_t y, const Colour& colour, double part) {
  std::uint8_t* const at = &pixels_.rgba[4 * (std::size_t{y} * pixels_.width + x)];
  const float channels[]{colour.r, colour.g, colour.b};
  for (int i = 0; i < 3; ++i) {
    const auto before = static_cast<float>(at[i]) / 255;
    at[i] = byte(before + (channels[i] - before) * static_cast<float>(part));
  }
}

void Canvas::draw(std::span<const shader::ViewStroke> strokes) {
  for (const shader::ViewStroke& stroke : strokes) {
    const Vec2 from(stroke.from.x, stroke.from.y), to(stroke.to.x, stroke.to.y);
    const double radius = stroke.from.w, reach = radius + 1;
    const auto first = [](double v) { return static_cast<std::uint32_t>(std::max(0.0, std::floor(v))); };
    const auto last = [](double v, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp(std::ceil(v), 0.0, static_cast<double>(size)));
    };
    const std::uint32_t right = last(std::max(from.x, to.x) + reach, pixels_.width),
                        bottom = last(std::max(from.y, to.y) + reach, pixels_.height);
    const Colour colour{stroke.colour.x, stroke.colour.y, stroke.colour.z};
    for (std::uint32_t y = first(std::min(from.y, to.y) - reach); y < bottom; ++y) {
      for (std::uint32_t x = first(std::min(from.x, to.x) - reach); x < right; ++x) {
        const double cover = std::clamp(radius + 0.5 - distance_to(from, to, {x + 0.5, y + 0.5}), 0.0, 1.0);
        if (cover > 0) blend(x, y, colour, cover * static_cast<double>(stroke.colour.w));
      }
    }
  }
}

}  // namespace palpa::drawing
