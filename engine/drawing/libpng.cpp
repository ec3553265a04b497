#include "drawing/libpng.hpp"

#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

// libpng reports errors by longjmp. Functions that it may jump out of hold no objects with destructors; their callers
// own all memory.
namespace palpa::drawing {
namespace libpng {

struct Fault {
  char text[160] = "";
};

struct Memory {
  const std::uint8_t* data;
  std::size_t left;
};

struct Header {
  png_uint_32 width = 0, height = 0;
  int bits = 0, colour = 0;
};

}  // namespace libpng

namespace {

using libpng::Fault;
using libpng::Header;
using libpng::Memory;

void on_error(png_structp png, png_const_charp text) {
  auto* fault = static_cast<Fault*>(png_get_error_ptr(png));
  std::snprintf(fault->text, sizeof(fault->text), "%s", text);
  for (char* c = fault->text; *c; ++c) {
    if (static_cast<unsigned char>(*c) < 0x20 || static_cast<unsigned char>(*c) > 0x7e) *c = ' ';
  }
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_memory(png_structp png, png_bytep out, std::size_t bytes) {
  auto* memory = static_cast<Memory*>(png_get_io_ptr(png));
  if (bytes > memory->left) png_error(png, "the file ends early");
  std::memcpy(out, memory->data, bytes);
  memory->data += bytes;
  memory->left -= bytes;
}

}  // namespace

struct PngValues::Reader {
  libpng::Fault fault;
  libpng::Memory memory{};
  libpng::Header header;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &fault, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  Reader() = default;
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }

  bool read_header();
  bool read_rows(int bits, png_bytepp rows);
};

bool PngValues::Reader::read_header() {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_read_fn(png, &memory, read_memory);
  png_set_user_limits(png, 0x7fffffff, 0x7fffffff);  // callers check the size with a better message
  png_set_chunk_malloc_max(png, 1 << 20);
  png_set_chunk_cache_max(png, 64);
  png_read_info(png, info);
  png_get_IHDR(png, info, &header.width, &header.height, &header.bits, &header.colour, nullptr, nullptr, nullptr);
  return true;
}

bool PngValues::Reader::read_rows(int bits, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

namespace {

std::uint32_t big_endian(const std::uint8_t* b) {
  return std::uint32_t{b[0]} << 24U | std::uint32_t{b[1]} << 16U | std::uint32_t{b[2]} << 8U | b[3];
}

/// Describes the first chunk that claims more bytes than the file has; libpng would allocate the claimed size.
std::optional<std::string> promise_fault(std::span<const std::uint8_t> png) {
  constexpr std::size_t signature = 8, around = 12;  // length, name and checksum of a chunk
  for (std::size_t at = signature; png.size() - at >= around;) {
    const std::size_t length = big_endian(png.data() + at), left = png.size() - at - around;
    const std::string name(reinterpret_cast<const char*>(png.data() + at + 4), 4);
    if (length > left) return fmt::format("chunk {} promises {} bytes, but {} are left", one_line(name), length, left);
    if (name == "IEND") break;
    at += around + length;
  }
  return std::nullopt;
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

bool write_rows(Writer& writer, std::string& out, std::uint32_t width, std::uint32_t height, int bits, png_bytepp rows,
                const char* keyword, const char* text) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_set_write_fn(writer.png, &out, append, flush_nothing);
  png_set_IHDR(writer.png, writer.info, width, height, bits, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  // A recording must keep up with the cameras.
  png_set_compression_level(writer.png, 1);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  if (keyword) {
    png_text entry = {};
    entry.compression = PNG_TEXT_COMPRESSION_NONE;
    entry.key = const_cast<char*>(keyword);
    entry.text = const_cast<char*>(text);
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

template <typename Value>
std::string encode_values(std::uint32_t width, std::uint32_t height, std::span<const Value> values,
                          const PngText* text = nullptr) {
  Writer writer;
  if (!writer.info) throw failure("out of memory");
  std::vector<png_bytep> rows = rows_of(values.data(), width, height);
  std::string bytes;
  bytes.reserve(most_png_bytes(width, height, sizeof(Value)));
  if (!write_rows(writer, bytes, width, height, 8 * sizeof(Value), rows.data(), text ? text->keyword.c_str() : nullptr,
                  text ? text->text.c_str() : nullptr))
    throw PngFault(writer.fault.text);
  return bytes;
}

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

bool begins_as_png(std::string_view bytes) {
  return bytes.size() >= 8 && png_sig_cmp(as_bytes(bytes).data(), 0, 8) == 0;
}

PngValues::PngValues(std::string_view bytes) {
  if (!begins_as_png(bytes)) throw PngFault("no PNG signature");
  const std::span<const std::uint8_t> png = as_bytes(bytes);
  if (const auto fault = promise_fault(png)) throw PngFault(*fault);
  reader_ = std::make_unique<Reader>();
  if (!reader_->info) throw failure("out of memory");
  reader_->memory = {png.data(), png.size()};
  if (!reader_->read_header()) throw PngFault(reader_->fault.text);
}

PngValues::~PngValues() = default;

std::uint32_t PngValues::width() const {
  return reader_->header.width;
}

std::uint32_t PngValues::height() const {
  return reader_->header.height;
}

bool PngValues::is_grey(int bits) const {
  return reader_->header.bits == bits && reader_->header.colour == PNG_COLOR_TYPE_GRAY;
}

std::string PngValues::kind() const {
  const Header& header = reader_->header;
  const char* colour = header.colour == PNG_COLOR_TYPE_GRAY         ? "grey"
                       : header.colour == PNG_COLOR_TYPE_GRAY_ALPHA ? "grey with alpha"
                       : header.colour == PNG_COLOR_TYPE_PALETTE    ? "palette"
                       : header.colour == PNG_COLOR_TYPE_RGB        ? "colour"
                                                                    : "colour with alpha";
  return fmt::format("{}-bit {}", header.bits, colour);
}

std::string PngValues::text(const char* keyword) const {
  png_textp texts = nullptr;
  const int count = png_get_text(reader_->png, reader_->info, &texts, nullptr);
  for (int i = 0; i < count; ++i) {
    if (std::strcmp(texts[i].key, keyword) == 0) return {texts[i].text, texts[i].text_length};
  }
  return {};
}

void PngValues::read_grey(std::span<std::uint8_t> values) {
  if (!is_grey(8) || values.size() != std::size_t{width()} * height()) throw failure("the values do not fit the image");
  std::vector<png_bytep> rows = rows_of(values.data(), width(), height());
  if (!reader_->read_rows(8, rows.data())) throw PngFault(reader_->fault.text);
}

void PngValues::read_grey(std::span<std::uint16_t> values) {
  if (!is_grey(16) || values.size() != std::size_t{width()} * height())
    throw failure("the values do not fit the image");
  std::vector<png_bytep> rows = rows_of(values.data(), width(), height());
  if (!reader_->read_rows(16, rows.data())) throw PngFault(reader_->fault.text);
}

std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> values) {
  return encode_values(width, height, values);
}

std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values) {
  return encode_values(width, height, values);
}

std::string png_of_values(std::uint32_t width, std::uint32_t height, std::span<const std::uint16_t> values,
                          const PngText& text) {
  return encode_values(width, height, values, &text);
}

struct PngPicture::Image {
  png_image image{};
  Image() { image.version = PNG_IMAGE_VERSION; }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  ~Image() { png_image_free(&image); }
};

PngPicture::PngPicture(std::string_view bytes) : image_(std::make_unique<Image>()) {
  png_image& image = image_->image;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) throw PngFault(image.message);
}

PngPicture::~PngPicture() = default;

std::uint32_t PngPicture::width() const {
  return image_->image.width;
}

std::uint32_t PngPicture::height() const {
  return image_->image.height;
}

std::vector<std::uint8_t> PngPicture::read_rgba() {
  png_image& image = image_->image;
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr)) throw PngFault(image.message);
  return rgba;
}

std::string png_of_picture(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  if (!png_image_write_to_memory(&image, nullptr, &size, 0, rgb.data(), 0, nullptr)) throw PngFault(image.message);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr)) throw PngFault(image.message);
  bytes.resize(size);
  return bytes;
}

}  // namespace palpa::drawing
