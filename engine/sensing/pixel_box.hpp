// A rectangle of an image's pixels.
#pragma once

#include <algorithm>
#include <cstdint>

namespace palpa::sensing {

/// Columns and rows, ends excluded.
struct PixelBox {
  std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

inline bool contains(const PixelBox& box, std::uint32_t u, std::uint32_t v) {
  return u >= box.x0 && u < box.x1 && v >= box.y0 && v < box.y1;
}

/// The smallest box around both.
inline PixelBox around(const PixelBox& a, const PixelBox& b) {
  if (a.empty() || b.empty()) return a.empty() ? b : a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// Grown by `by` pixels on each side, clipped to the image.
inline PixelBox grown(const PixelBox& box, std::uint32_t by, std::uint32_t width, std::uint32_t height) {
  if (box.empty()) return box;
  return {box.x0 - std::min(by, box.x0), box.y0 - std::min(by, box.y0), std::min(box.x1 + by, width),
          std::min(box.y1 + by, height)};
}

}  // namespace palpa::sensing
