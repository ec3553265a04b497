#include "sensing/grey_png.hpp"

#include <fmt/format.h>

#include <string>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "drawing/libpng.hpp"

namespace palpa::sensing {
namespace {

constexpr const char* camera_keyword = "Camera";

/// `what` describes such an image in messages: "a depth image".
template <typename Pixel>
void read_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height, const char* what,
              std::vector<Pixel>& out, std::string* camera = nullptr) {
  constexpr int bits = 8 * sizeof(Pixel);
  const std::string bytes = read_file(file, drawing::most_png_bytes(width, height, sizeof(Pixel)));
  if (!drawing::begins_as_png(bytes)) throw bad_input(file.string(), "is not a PNG file");
  try {
    drawing::PngValues png(bytes);
    if (!png.is_grey(bits)) {
      throw bad_input(file.string(), fmt::format("is a {} PNG, but {} must be {}-bit grey", png.kind(), what, bits));
    }
    if (png.width() != width || png.height() != height) {
      throw bad_input(file.string(), fmt::format("is {}x{} pixels, but its camera is {}x{}", png.width(), png.height(),
                                                 width, height));
    }
    if (camera) *camera = png.text(camera_keyword);
    out.resize(std::size_t{width} * height);
    png.read_grey(out);
  } catch (const drawing::PngFault& fault) {
    throw bad_input(file.string(), fmt::format("is a broken PNG file: {}", fault.what()));
  }
}

template <typename Pixel>
void write_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::span<const Pixel> pixels, const std::string& camera = {}) {
  if (width == 0 || height == 0 || pixels.size() != std::size_t{width} * height) {
    throw bad_usage(fmt::format("{} pixels do not make an image of {}x{}", pixels.size(), width, height));
  }
  std::string bytes;
  try {
    if constexpr (sizeof(Pixel) == 2) {
      bytes = camera.empty() ? drawing::png_of_values(width, height, pixels)
                             : drawing::png_of_values(width, height, pixels, {camera_keyword, camera});
    } else {
      bytes = drawing::png_of_values(width, height, pixels);
    }
  } catch (const drawing::PngFault& fault) {
    throw failure(fmt::format("{}: cannot be encoded: {}", file.string(), fault.what()));
  }
  write_file(file, bytes);
}

}  // namespace

void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out) {
  read_png(file, width, height, "a depth image", out);
}

void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out, std::string& camera) {
  read_png(file, width, height, "a background", out, &camera);
}

void read_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::vector<std::uint8_t>& out) {
  read_png(file, width, height, "a mask", out);
}

void write_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                 std::span<const std::uint16_t> pixels, const std::string& camera) {
  write_png(file, width, height, pixels, camera);
}

void write_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::span<const std::uint8_t> pixels) {
  write_png(file, width, height, pixels);
}

}  // namespace palpa::sensing
