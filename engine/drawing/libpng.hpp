// Images in memory to the bytes of a PNG file and back: the one place that knows libpng.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::drawing {

/// What libpng has against bytes or pixels, as printable ASCII.
class PngFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

bool begins_as_png(std::string_view bytes);

/// No PNG of such an image is larger: deflate never grows data by much; the rest is room for ancillary chunks.
constexpr std::uint64_t most_png_bytes(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes) {
  const std::uint64_t bytes = std::uint64_t{width} * height * pixel_bytes;
  return bytes + bytes / 8 + (4U << 20);
}

/// A PNG whose values are wanted as they are: gamma and other ancillary chunks do not change them. Interlaced files are
/// fine. `bytes` outlives the reader. Reserves no more than the file's own size and that of the rows.
class PngValues {
 public:
  /// Reads the header. Throws PngFault where it is broken, and where a chunk promises more than the file has; failure
  /// without memory.
  explicit PngValues(std::string_view bytes);
  ~PngValues();
  PngValues(const PngValues&) = delete;
  PngValues& operator=(const PngValues&) = delete;

  std::uint32_t width() const;
  std::uint32_t height() const;
  /// Whether each pixel is one grey value of so many bits.
  bool is_grey(int bits) const;
  /// "16-bit grey", "8-bit colour with alpha", ...
  std::string kind() const;
  /// Once. Rows from the top, width() x height() values of 1 or 2 bytes each. Throws PngFault where the file ends early
  /// or is corrupt.
  void read_grey(std::span<std::uint8_t> values);
  void read_grey(std::span<std::uint16_t> values);

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

/// Grey, fast rather than small. Rows from the top; width and height are not 0. Throws PngFault; failure without
/// memory.
std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> values);
std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values);

/// A PNG as a picture: of any kind, turned into red, green, blue and alpha as on the screen. `bytes` outlives it.
class PngPicture {
 public:
  /// Reads the header. Throws PngFault where these bytes are no PNG.
  explicit PngPicture(std::string_view bytes);
  ~PngPicture();
  PngPicture(const PngPicture&) = delete;
  PngPicture& operator=(const PngPicture&) = delete;

  std::uint32_t width() const;
  std::uint32_t height() const;
  /// Once. 4 bytes per pixel, rows from the top. Throws PngFault where the file is broken.
  std::vector<std::uint8_t> read_rgba();

 private:
  struct Image;
  std::unique_ptr<Image> image_;
};

/// `rgb` has 3 bytes per pixel, rows from the top. The same pixels give the same bytes. Throws PngFault.
std::string png_of_picture(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb);

}  // namespace palpa::drawing
