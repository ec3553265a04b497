#include "drawing/png.hpp"

#include <fmt/core.h>
#include <png.h>
#include <cmath>

#include <cstdlib>
#include <memory>
#include <string>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/output_file.hpp"

namespace palpa::drawing {
void write_png(const std::filesystem::path& file, const Pixels& pixels) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(pixels.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < pixels.rgba.size(); i += 4) {
    rgb.insert(rgb.end(), pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i),
               pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = pixels.width;
  image.height = pixels.height;
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (!png_image_write_to_memory(&image, nullptr, &size, 0, rgb.data(), 0, nullptr)) {
    throw failure(
        fmt::format("{}: cannot encode {}x{} pixels: {}", file.string(), pixels.width, pixels.height, image.message));
  }
  std::vector<std::uint8_t> bytes(size);
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr)) {
    throw failure(fmt::format("{}: cannot encode: {}", file.string(), image.message));
  }
  write_file(file, {reinterpret_cast<const char*>(bytes.data()), size});
}

Pixels read_png(const std::filesystem::path& file) {
  constexpr std::uint32_t most = 16384;
  const std::string bytes = read_file(file, std::uint64_t{most} * most * 4);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, decltype(&png_image_free)> guard(&image, png_image_free);
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) {
    throw bad_input(file.string(), fmt::format("is no PNG picture ({})", image.message));
  }
  if (image.width > most || image.height > most) {
    throw bad_input(file.string(),
                    fmt::format("is {}x{} pixels large: at most {} on a side", image.width, image.height, most));
  }
  image.format = PNG_FORMAT_RGBA;
  Pixels pixels{image.width, image.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, pixels.rgba.data(), 0, nullptr)) {
    throw bad_input(file.string(), fmt::format("is a broken PNG picture ({})", image.message));
  }
  return pixels;
}

double mean_difference(const Pixels& a, const Pixels& b) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % 4 != 3) sum += static_cast<std::uint64_t>(std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
  }
  const double samples = 3.0 * a.width * a.height;
  return samples > 0 ? static_cast<double>(sum) / (255.0 * samples) : 0.0;
}

}  // namespace palpa::drawing
