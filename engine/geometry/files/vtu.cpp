#include "geometry/files/vtu.hpp"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <cstring>

#include "base/files/output_file.hpp"

namespace palpa::geometry {
namespace {

static_assert(std::endian::native == std::endian::little);

/// Base64 in pieces: bytes that do not fill a group of three wait for the next piece.
class Base64 {
 public:
  explicit Base64(OutputFile& file) : file_(file) {}

  void add(const void* data, std::size_t bytes) {
    const auto* const from = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) {
      bits_ = bits_ << 8 | from[i];
      if (++waiting_ < 3) continue;
      put(4);
    }
  }
  void finish() {
    if (waiting_ > 0) {
      const unsigned missing = 3 - waiting_;
      bits_ <<= 8 * missing;
      put(4 - missing);
      text_.append(missing, '=');
    }
    file_.write(text_);
    text_.clear();
  }

 private:
  void put(unsigned digits) {
    static constexpr char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (unsigned i = 0; i < digits; ++i)
      text_ += alphabet[bits_ >> (18 - 6 * i) & 63];
    bits_ = waiting_ = 0;
    if (text_.size() < (1u << 20)) return;
    file_.write(text_);
    text_.clear();
  }

  OutputFile& file_;
  std::string text_;
  std::uint32_t bits_ = 0;
  unsigned waiting_ = 0;
};

/// The file under construction.
class Document {
 public:
  explicit Document(const std::filesystem::path& file) : file_(file) {}

  void line(std::string_view text) {
    file_.write(text);
    file_.write("\n");
  }
  /// An array of `count` values of `T`, each made by a call.
  template <typename T, typename Make>
  void values(const char* type, const std::string& name, unsigned components, std::uint64_t count, const Make& make) {
    line(fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="binary">)", type, name,
                     components));
    const std::uint64_t bytes = count * sizeof(T);
    Base64 header(file_);
    header.add(&bytes, sizeof(bytes));
    header.finish();
    Base64 body(file_);
    for (std::uint64_t i = 0; i < count; ++i) {
      const T value = make(i);
      body.add(&value, sizeof(value));
    }
    body.finish();
    line("\n</DataArray>");
  }
  void finish() { file_.finish(); }

 private:
  OutputFile file_;
};

std::uint64_t corners_of(VtuCells::Shape shape) {
  switch (shape) {
    case VtuCells::Shape::vertex:
      return 1;
    case VtuCells::Shape::line:
      return 2;
    case VtuCells::Shape::triangle:
      return 3;
    case VtuCells::Shape::quad:
      return 4;
  }
  return 1;
}

void add_data(Document& document, const char* tag, std::span<const VtuValues> all, std::size_t count) {
  document.line(fmt::format("<{}>", tag));
  for (const VtuValues& one : all) {
    assert(one.values.size() == count);
    document.values<float>("Float32", one.name, 1, count, [&](std::uint64_t i) { return one.values[i]; });
  }
  document.line(fmt::format("</{}>", tag));
}

}  // namespace

void write_vtu(const std::filesystem::path& file, std::span<const Vec3> points, const VtuCells& cells,
               std::span<const VtuValues> of_points, std::span<const VtuValues> of_cells) {
  const std::uint64_t per_cell = corners_of(cells.shape), count = cells.corners.size() / per_cell;
  Document out(file);
  out.line(R"(<?xml version="1.0"?>)");
  out.line(R"(<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">)");
  out.line("<UnstructuredGrid>");
  out.line(fmt::format(R"(<Piece NumberOfPoints="{}" NumberOfCells="{}">)", points.size(), count));
  add_data(out, "PointData", of_points, points.size());
  add_data(out, "CellData", of_cells, count);
  out.line("<Points>");
  out.values<double>("Float64", "Points", 3, points.size() * 3,
                     [&](std::uint64_t i) { return points[i / 3][static_cast<int>(i % 3)]; });
  out.line("</Points>\n<Cells>");
  out.values<std::int64_t>("Int64", "connectivity", 1, cells.corners.size(),
                           [&](std::uint64_t i) { return std::int64_t{cells.corners[i]}; });
  out.values<std::int64_t>("Int64", "offsets", 1, count,
                           [&](std::uint64_t i) { return static_cast<std::int64_t>((i + 1) * per_cell); });
  out.values<std::uint8_t>("UInt8", "types", 1, count,
                           [&](std::uint64_t) { return static_cast<std::uint8_t>(cells.shape); });
  out.line("</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>");
  out.finish();
}

}  // namespace palpa::geometry
