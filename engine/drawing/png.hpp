// 8-bit pictures in memory and as PNG files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace palpa::drawing {

/// Rows from the top, 4 bytes per pixel: red, green, blue, alpha as on the screen.
struct Pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;

  const std::uint8_t* at(std::uint32_t x, std::uint32_t y) const {
    return rgba.data() + (static_cast<std::size_t>(y) * width + x) * 4;
  }
};

/// Writes an RGB PNG without times or other text, so the same pixels give the same bytes. Throws failure() naming the
/// file if it cannot be written completely.
void write_png(const std::filesystem::path& file, const Pixels& pixels);

/// Throws bad_input naming the file: missing, not a regular file, not a PNG, broken, or larger than 16384 pixels on a
/// side.
Pixels read_png(const std::filesystem::path& file);

/// Mean absolute difference of red, green and blue over all pixels, 0..1. The pictures must have the same size.
double mean_difference(const Pixels& a, const Pixels& b);

}  // namespace palpa::drawing
