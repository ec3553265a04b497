#include "sensing/grey_png.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/output_file.hpp"
#include "base/text.hpp"

// libpng reports errors by longjmp. The functions that it may jump out of hold nothing with a destructor; what owns
// memory lives in their callers.
namespace palpa::sensing {
namespace {

struct Fault {
  char text[160] = "";
};

void on_error(png_structp png, png_const_charp text) {
  auto* fault = static_cast<Fault*>(png_get_error_ptr(png));
  std::snprintf(fault->text, sizeof(fault->text), "%s", text);
  for (char* c = fault->text; *c; ++c) {
    if (static_cast<unsigned char>(*c) < 0x20 || static_cast<unsigned char>(*c) > 0x7e) *c = ' ';
  }
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

struct Memory {
  const std::uint8_t* data;
  std::size_t left;
};

void read_memory(png_structp png, png_bytep out, std::size_t bytes) {
  auto* memory = static_cast<Memory*>(png_get_io_ptr(png));
  if (bytes > memory->left) png_error(png, "the file ends early");
  std::memcpy(out, memory->data, bytes);
  memory->data += bytes;
  memory->left -= bytes;
}

struct Reader {
  Fault fault;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &fault, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct Header {
  png_uint_32 width = 0, height = 0;
  int bits = 0, colour = 0;
};

bool read_header(Reader& reader, Memory& memory, Header& header) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_set_read_fn(reader.png, &memory, read_memory);
  png_set_user_limits(reader.png, 0x7fffffff, 0x7fffffff);  // the size is checked here, with a better message
  png_set_chunk_malloc_max(reader.png, 1 << 20);
  png_set_chunk_cache_max(reader.png, 64);
  png_read_info(reader.png, reader.info);
  png_get_IHDR(reader.png, reader.info, &header.width, &header.height, &header.bits, &header.colour, nullptr, nullptr,
               nullptr);
  return true;
}

bool read_rows(Reader& reader, int bits, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

std::uint32_t big_endian(const std::uint8_t* b) {
  return std::uint32_t{b[0]} << 24U | std::uint32_t{b[1]} << 16U | std::uint32_t{b[2]} << 8U | b[3];
}

/// The first chunk that promises more than the file has, in words; libpng would make room for what is promised.
std::optional<std::string> promise_fault(std::span<const std::uint8_t> png) {
  constexpr std::size_t signature = 8, around = 12;  // length, name and checksum of a chunk
  for (std::size_t at = signature; png.size() - at >= around;) {
    const std::size_t length = big_endian(png.data() + at), left = png.size() - at - around;
    const std::string name(reinterpret_cast<const char*>(png.data() + at + 4), 4);
    if (length > left) return fmt::format("chunk {} promises {} bytes, {} are left", one_line(name), length, left);
    if (name == "IEND") break;
    at += around + length;
  }
  return std::nullopt;
}

std::string kind_of(const Header& header) {
  const char* colour = header.colour == PNG_COLOR_TYPE_GRAY         ? "grey"
                       : header.colour == PNG_COLOR_TYPE_GRAY_ALPHA ? "grey with alpha"
                       : header.colour == PNG_COLOR_TYPE_PALETTE    ? "palette"
                       : header.colour == PNG_COLOR_TYPE_RGB        ? "colour"
                                                                    : "colour with alpha";
  return fmt::format("{}-bit {}", header.bits, colour);
}

struct Writer {
  Fault fault;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &fault, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Writer() = default;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

void append(png_structp png, png_bytep data, std::size_t bytes) {
  auto& out = *static_cast<std::string*>(png_get_io_ptr(png));
  // Reserved before: nothing may be thrown through libpng.
  if (bytes > out.capacity() - out.size()) png_error(png, "more bytes than pixels can take");
  out.append(reinterpret_cast<const char*>(data), bytes);
}

void flush_nothing(png_structp) {}

bool write_rows(Writer& writer, std::string& out, std::uint32_t width, std::uint32_t height, int bits,
                png_bytepp rows) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_set_write_fn(writer.png, &out, append, flush_nothing);
  png_set_IHDR(writer.png, writer.info, width, height, bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // A recording must keep up with the cameras.
  png_set_compression_level(writer.png, 1);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
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

/// Deflate never grows data by much; the rest is room for ancillary chunks.
std::uint64_t most_bytes(std::uint32_t width, std::uint32_t height, std::size_t pixel_bytes) {
  const std::uint64_t bytes = std::uint64_t{width} * height * pixel_bytes;
  return bytes + bytes / 8 + (4u << 20);
}

/// `what` is what such an image is, for messages: "a depth image".
template <typename Pixel>
void read_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height, const char* what,
              std::vector<Pixel>& out) {
  constexpr int bits = 8 * sizeof(Pixel);
  const std::string contents = read_file(file, most_bytes(width, height, sizeof(Pixel)));
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(contents.data()), contents.size());
  if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0) throw bad_input(file.string(), "is not a PNG file");
  if (const auto fault = promise_fault(bytes))
    throw bad_input(file.string(), fmt::format("is a broken PNG file: {}", *fault));

  Reader reader;
  if (!reader.info) throw failure("out of memory");
  Memory memory{bytes.data(), bytes.size()};
  Header header;
  if (!read_header(reader, memory, header)) {
    throw bad_input(file.string(), fmt::format("is a broken PNG file: {}", reader.fault.text));
  }
  if (header.bits != bits || header.colour != PNG_COLOR_TYPE_GRAY) {
    throw bad_input(file.string(), fmt::format("is a {} PNG, {} is {}-bit grey", kind_of(header), what, bits));
  }
  if (header.width != width || header.height != height) {
    throw bad_input(file.string(),
                    fmt::format("is {}x{} pixels, its camera is {}x{}", header.width, header.height, width, height));
  }
  out.resize(std::size_t{width} * height);
  std::vector<png_bytep> rows = rows_of(out.data(), width, height);
  if (!read_rows(reader, bits, rows.data())) {
    throw bad_input(file.string(), fmt::format("is a broken PNG file: {}", reader.fault.text));
  }
}

template <typename Pixel>
void write_png(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::span<const Pixel> pixels) {
  if (width == 0 || height == 0 || pixels.size() != std::size_t{width} * height) {
    throw bad_usage(fmt::format("{} pixels do not make an image of {}x{}", pixels.size(), width, height));
  }
  Writer writer;
  if (!writer.info) throw failure("out of memory");
  std::vector<png_bytep> rows = rows_of(pixels.data(), width, height);
  std::string bytes;
  bytes.reserve(most_bytes(width, height, sizeof(Pixel)));
  if (!write_rows(writer, bytes, width, height, 8 * sizeof(Pixel), rows.data())) {
    throw failure(fmt::format("{}: cannot be encoded: {}", file.string(), writer.fault.text));
  }
  write_file(file, bytes);
}

}  // namespace

void read_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::vector<std::uint16_t>& out) {
  read_png(file, width, height, "a depth image", out);
}

void read_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
               std::vector<std::uint8_t>& out) {
  read_png(file, width, height, "a mask", out);
}

void write_png16(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                 std::span<const std::uint16_t> pixels) {
  write_png(file, width, height, pixels);
}

void write_png8(const std::filesystem::path& file, std::uint32_t width, std::uint32_t height,
                std::span<const std::uint8_t> pixels) {
  write_png(file, width, height, pixels);
}

}  // namespace palpa::sensing
