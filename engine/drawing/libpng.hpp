// Converts images in memory to the bytes of a PNG file and back. The only place that uses libpng.
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

/// libpng's complaint about bytes or pixels, as printable ASCII.
class PngFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

bool begins_as_png(std::string_view bytes);

/// Upper bound for the size of a PNG of such an image. Deflate hardly expands data; the rest is room for ancillary
/// chunks.
constexpr std::uint64_t most_png_bytes(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes) {
  const std::uint64_t bytes = std::uint64_t{width} * height * pixel_bytes;
  return bytes + bytes / 8 + (4U << 20);
}

/// A PNG whose raw values are wanted: gamma and other ancillary chunks do not change them. Interlaced files are
/// supported. `bytes` must outlive the reader. Reserves at most the file's own size plus that of the rows.
class PngValues {
 public:
  /// Reads the header. Throws PngFault if it is broken or if a chunk claims more than the file has; failure if memory
  /// is short.
  explicit PngValues(std::string_view bytes);
  ~PngValues();
  PngValues(const PngValues&) = delete;
  PngValues& operator=(const PngValues&) = delete;

  std::uint32_t width() const;
  std::uint32_t height() const;
  /// Whether each pixel is one grey value of `bits` bits.
  bool is_grey(int bits) const;
  /// "16-bit grey", "8-bit colour with alpha", ...
  std::string kind() const;
  /// The text that the file has under this keyword; empty if it has none.
  std::string text(const char* keyword) const;
  /// Call once. Rows from the top, width() x height() values of 1 or 2 bytes each. Throws PngFault if the file ends
  /// early or is corrupt.
  void read_grey(std::span<std::uint8_t> values);
  void read_grey(std::span<std::uint16_t> values);

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

/// A text that a PNG carries beside its image, in a tEXt chunk: at most a few kilobytes.
struct PngText {
  std::string keyword;  ///< 1 to 79 letters
  std::string text;
};

/// Grey, optimised for speed rather than size. Rows from the top; width and height are not 0. Throws PngFault; failure
/// if memory is short.
std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> values);
std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values);
std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values,
                          const PngText& text);

/// A PNG of any kind as a picture, converted to red, green, blue and alpha as on the screen. `bytes` must outlive it.
class PngPicture {
 public:
  /// Reads the header. Throws PngFault if the bytes are not a PNG.
  explicit PngPicture(std::string_view bytes);
  ~PngPicture();
  PngPicture(const PngPicture&) = delete;
  PngPicture& operator=(const PngPicture&) = delete;

  std::uint32_t width() const;
  std::uint32_t height() const;
  /// Call once. 4 bytes per pixel, rows from the top. Throws PngFault if the file is broken.
  std::vector<std::uint8_t> read_rgba();

 private:
  struct Image;
  std::unique_ptr<Image> image_;
};

/// `rgb` has 3 bytes per pixel, rows from the top. The same pixels give the same bytes. Throws PngFault.
std::string png_of_picture(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb);

}  // namespace palpa::drawing
