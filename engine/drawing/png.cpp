#include "drawing/png.hpp"

#include <fmt/core.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/output_file.hpp"

namespace palpa::drawing {
namespace {

struct PngImage : png_image {
  PngImage() : png_image{} { version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(this); }
};

}  // namespace

void write_png(const std::filesystem::path& file, const Pixels& pixels) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(pixels.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < pixels.rgba.size(); i += 4) {
    rgb.insert(rgb.end(), pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i),
               pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  PngImage image;
  image.width = pixels.width;
  image.height = pixels.height;
  image.format = PNG_FORMAT_RGB;
  std::string bytes;
  png_alloc_size_t size = 0;
  const auto encode = [&](char* out) {
    if (png_image_write_to_memory(&image, out, &size, 0, rgb.data(), 0, nullptr)) return;
    throw failure(
        fmt::format("{}: cannot encode {}x{} pixels: {}", file.string(), pixels.width, pixels.height, image.message));
  };
  encode(nullptr);
  bytes.resize(size);
  encode(bytes.data());
  bytes.resize(size);
  write_file(file, bytes);
}

Pixels read_png(const std::filesystem::path& file) {
  constexpr std::uint32_t most = 16384;
  const std::string bytes = read_file(file, std::uint64_t{most} * most * 4);
  PngImage image;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
    throw bad_input(file.string(), fmt::format("is not a PNG picture ({})", image.message));
  if (image.width > most || image.height > most) {
    throw bad_input(file.string(), fmt::format("is {}x{} pixels large; it may have at most {} on a side", image.width,
                                               image.height, most));
  }
  image.format = PNG_FORMAT_RGBA;
  Pixels pixels{image.width, image.height, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, pixels.rgba.data(), 0, nullptr))
    throw bad_input(file.string(), fmt::format("is a broken PNG picture ({})", image.message));
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
