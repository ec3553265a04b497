#include "drawing/png.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "drawing/libpng.hpp"

namespace palpa::drawing {
namespace {

PngPicture picture_in(const std::filesystem::path& file, const std::string& bytes) {
  try {
    return PngPicture(bytes);
  } catch (const PngFault& fault) {
    throw bad_input(file.string(), fmt::format("is not a PNG picture ({})", fault.what()));
  }
}

}  // namespace

void write_png(const std::filesystem::path& file, const Pixels& pixels) {
  std::vector<std::uint8_t> rgb;
  rgb.reserve(pixels.rgba.size() / 4 * 3);
  for (std::size_t i = 0; i + 3 < pixels.rgba.size(); i += 4) {
    rgb.insert(rgb.end(), pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i),
               pixels.rgba.begin() + static_cast<std::ptrdiff_t>(i + 3));
  }
  std::string bytes;
  try {
    bytes = png_of_picture(pixels.width, pixels.height, rgb);
  } catch (const PngFault& fault) {
    throw failure(
        fmt::format("{}: cannot encode {}x{} pixels: {}", file.string(), pixels.width, pixels.height, fault.what()));
  }
  write_file(file, bytes);
}

Pixels read_png(const std::filesystem::path& file) {
  constexpr std::uint32_t most = 16384;
  const std::string bytes = read_file(file, std::uint64_t{most} * most * 4);
  PngPicture picture = picture_in(file, bytes);
  if (picture.width() > most || picture.height() > most) {
    throw bad_input(file.string(), fmt::format("is {}x{} pixels large; it may have at most {} on a side",
                                               picture.width(), picture.height(), most));
  }
  try {
    return {picture.width(), picture.height(), picture.read_rgba()};
  } catch (const PngFault& fault) {
    throw bad_input(file.string(), fmt::format("is a broken PNG picture ({})", fault.what()));
  }
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
