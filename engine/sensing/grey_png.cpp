#include "sensing/grey_png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/output_file.hpp"
#include "base/text.hpp"

// libpng reports errors by longjmp. Functions that it may jump out of hold no objects with destructors; their callers
// own all memory.
namespace palpa::sensing {
namespace {

constexpr const char* camera_keyword = "Camera";

/// Upper bound for the size of a PNG of such an image. Deflate hardly expands data; the rest is room for ancillary
/// chunks.
constexpr std::uint64_t most_png_bytes(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes) {
  const std::uint64_t bytes = std::uint64_t{width} * height * pixel_bytes;
  return bytes + bytes / 8 + (4U << 20);
}

/// libpng's complaint, as printable ASCII.
struct PngFault {
  char text[160] = "";
};

void on_error(png_structp png, png_const_charp text) {
  auto* fault = static_cast<PngFault*>(png_get_error_ptr(png));
  std::snprintf(fault->text, sizeof(fault->text), "%s", text);
  for (char* c = fault->text; *c; ++c) {
    if (static_cast<unsigned char>(*c) < 0x20 || static_cast<unsigned char>(*c) > 0x7e) *c = ' ';
  }
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_memory(png_structp png, png_bytep out, std::size_t bytes) {
  auto* left = static_cast<std::string_view*>(png_get_io_ptr(png));
  if (bytes > left->size()) png_error(png, "the file ends early");
  std::memcpy(out, left->data(), bytes);
  left->remove_prefix(bytes);
}

/// Reads raw values: gamma and other ancillary chunks do not change them. Reserves at most the file's own size plus
/// that of the rows.
struct PngReader {
  PngFault fault;
  std::string_view left;  ///< of the file
  png_uint_32 width = 0, height = 0;
  int bits = 0, colour = 0;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &fault, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  explicit PngReader(std::string_view bytes) : left(bytes) {}
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  bool read_header();
  bool read_rows(png_bytepp rows);
  std::string kind() const;
  /// The text that the file has under this keyword; empty if it has none.
  std::string text(const char* keyword) const;
};

bool PngReader::read_header() {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, &left, read_memory);
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // callers check the size with a better message
  png_set_chunk_malloc_max(png, 1 << 20);
  png_set_chunk_cache_max(png, 64);
  png_read_info(png, info);
  png_get_IHDR(png, info, &width, &height, &bits, &colour, nullptr, nullptr, nullptr);
  return true;
}

bool PngReader::read_rows(png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

/// "16-bit grey", "8-bit colour with alpha", ...
std::string PngReader::kind() const {
  const char* name = colour == PNG_COLOR_TYPE_GRAY         ? "grey"
                     : colour == PNG_COLOR_TYPE_GRAY_ALPHA ? "grey with alpha"
                     : colour == PNG_COLOR_TYPE_PALETTE    ? "palette"
                     : colour == PNG_COLOR_TYPE_RGB        ? "colour"
                                                           : "colour with alpha";
  return fmt::format("{}-bit {}", bits, name);
}

std::string PngReader::text(const char* keyword) const {
  png_textp texts = nullptr;
  const int count = png_get_text(png, info, &texts, nullptr);
  for (int i = 0; i < count; ++i) {
    if (std::strcmp(texts[i].key, keyword) == 0) return {texts[i].text, texts[i].text_length};
  }
  return {};
}

const std::uint8_t* as_bytes(std::string_view text) {
  return reinterpret_cast<const std::uint8_t*>(text.data());
}

std::uint32_t big_endian(const std::uint8_t* b) {
  return std::uint32_t{b[0]} << 24U | std::uint32_t{b[1]} << 16U | std::uint32_t{b[2]} << 8U | b[3];
}

/// Describes the first chunk that claims more bytes than the file has; libpng would allocate the claimed size.
std::optional<std::string> promise_fault(std::string_view png) {
  constexpr std::size_t signature = 8, around = 12;  // length, name and checksum of a chunk
  for (std::size_t at = signature; png.size() - at >= around;) {
    const std::size_t length = big_endian(as_bytes(png) + at), left = png.size() - at - around;
    const std::string_view name = png.substr(at + 4, 4);
    if (length > left) return fmt::format("chunk {} promises {} bytes, but {} are left", one_line(name), length, left);
    if (name == "IEND") break;
    at += around + length;
  }
  return std::nullopt;
}

struct PngWriter {
  PngFault fault;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &fault, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  PngWriter() = default;
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

void append_bytes(png_structp png, png_bytep data, std::size_t bytes) {
  auto& out = *static_cast<std::string*>(png_get_io_ptr(png));
  // Reserved before: nothing may be thrown through libpng.
  if (bytes > out.capacity() - out.size()) png_error(png, "more bytes than pixels can take");
  out.append(reinterpret_cast<const char*>(data), bytes);
}

void flush_nothing(png_structp) {}

/// `camera` is a text beside the image, in a tEXt chunk; nullptr: none.
bool write_rows(PngWriter& writer, std::string& out, std::uint32_t width, std::uint32_t height, int bits,
                png_bytepp rows, const char* camera) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_set_write_fn(writer.png, &out, append_bytes, flush_nothing);
  png_set_IHDR(writer.png, writer.info, width, height, bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // A recording must keep up with the cameras.
  png_set_compression_level(writer.png, 1);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  if (camera) {
    png_text entry = {};
    entry.compression = PNG_TEXT_COMPRESSION_NONE;
    entry.key = const_cast<char*>(camera_keyword);
    entry.text = const_cast<char*>(camera);
    png_set_text(writer.png, writer.info, &entry, 1);
  }
  png_write_info(writer.png, writer.info);
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(writer.png);
  png_write_image(writer.png, rows);
  png_write_end(writer.png, nullptr);
  return true;
}

template <typename Pixel>
std::vector<png_bytep> rows_of(const Pixel* pixels, std::uint32_t width, std::uint32_t height) {
  std::vector<png_bytep> rows(height);
  auto* bytes = reinterpret_cast<png_bytep>(const_cast<Pixel*>(pixels));
  for (std::uint32_t v = 0; v < height; ++v)
    rows[v] = bytes + std::size_t{v} * width * sizeof(Pixel);
  return rows;
}

/// Returns what is wrong, in words that follow the image's name; empty if nothing is. `what` describes such an image:
/// "a depth image".
template <typename Pixel>
std::string decode_png(std::string_view bytes, std::uint32_t width, std::uint32_t height, const char* what,
                       std::vector<Pixel>& out, std::string* camera = nullptr) {
  constexpr int bits = 8 * sizeof(Pixel);
  const auto broken = [](std::string_view fault) { return fmt::format("is a broken PNG file: {}", fault); };
  if (bytes.size() < 8 || png_sig_cmp(as_bytes(bytes), 0, 8) != 0) return "is not a PNG file";
  if (const auto fault = promise_fault(bytes)) return broken(*fault);
  PngReader png(bytes);
  if (!png.info) throw failure("out of memory");
  if (!png.read_header()) return broken(png.fault.text);
  if (png.bits != bits || png.colour != PNG_COLOR_TYPE_GRAY)
    return fmt::format("is a {} PNG, but {} must be {}-bit grey", png.kind(), what, bits);
  if (png.width != width || png.height != height)
    return fmt::format("is {}x{} pixels, but its camera is {}x{}", png.width, png.height, width, height);
  if (camera) *camera = png.text(camera_keyword);
  out.resize(std::size_t{width} * height);
  std::vector<png_bytep> rows = rows_of(out.data(), width, height);
  return png.read_rows(rows.data()) ? "" : broken(png.fault.text);
}

template <typename Pixel>
void read_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height, const char* what,
              std::vector<Pixel>& out, std::string* camera = nullptr) {
  const std::string bytes = read_file(file, most_png_bytes(width, height, sizeof(Pixel)));
  const std::string fault = decode_png(bytes, width, height, what, out, camera);
  if (!fault.empty()) throw bad_input(file.string(), fault);
}

template <typename Pixel>
void write_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::span<const Pixel> pixels, const std::string& camera = {}) {
  if (width == 0 || height == 0 || pixels.size() != std::size_t{width} * height) {
    throw bad_usage(fmt::format("{} pixels do not make an image of {}x{}", pixels.size(), width, height));
  }
  PngWriter png;
  if (!png.info) throw failure("out of memory");
  std::vector<png_bytep> rows = rows_of(pixels.data(), width, height);
  std::string bytes;
  bytes.reserve(most_png_bytes(width, height, sizeof(Pixel)));
  if (!write_rows(png, bytes, width, height, 8 * sizeof(Pixel), rows.data(), camera.empty() ? nullptr : camera.c_str()))
    throw failure(fmt::format("{}: cannot be encoded: {}", file.string(), png.fault.text));
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

std::string decode_png16(std::string_view png, std::uint32_t width, std::uint32_t height,
                         std::vector<std::uint16_t>& out) {
  return decode_png(png, width, height, "a depth image", out);
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
