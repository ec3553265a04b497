#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/files/ply_header.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry {
namespace {

using namespace ply;

constexpr std::size_t longest_gap = 4 << 10;                                // white space between two ascii values
constexpr std::uint64_t longest_rest = 64 << 20;                            // of a file, searched for surplus lines
constexpr std::size_t longest_token = 400;                                  // the longest plain decimal of a double
constexpr std::uint64_t most_vertices = 1 << 24, most_triangles = 1 << 24;  // 400 MB and 200 MB
constexpr std::uint64_t most_corners = 1 << 16;                             // of one polygon

// The file in order, through a buffer of fixed size.
class Reader {
 public:
  Reader(const InputFile& file, const Header& header)
      : file_(file),
        format_(header.format),
        position_(header.bytes),
        line_(header.lines + 1),
        line_end_(header.line_end) {}

  // The next value of any type. Throws if the file ends or contains no such number.
  double value(Type type) { return format_ == Format::ascii ? ascii_value(type) : binary_value(type); }

  /// Skips `count` values of a binary file without reading them.
  void leap(Type type, std::uint64_t count) {
    const std::uint64_t left = file_.size() - position_ - begin_;
    const std::size_t size = type_size[static_cast<std::size_t>(type)];
    if (count > left / size) fail("the file ends before all the elements of its header");
    const std::uint64_t target = position_ + begin_ + count * size;
    if (target <= position_ + end_) {
      begin_ = static_cast<std::size_t>(target - position_);
    } else {
      position_ = target;
      begin_ = end_ = 0;
    }
  }
  bool binary() const { return format_ != Format::ascii; }

  /// In an ascii file, a row is a line. Numbers that its element does not promise would shift all that follows.
  void begin_row(const Element& element) {
    numbers_ = 0;
    promised_ = element.properties.size();
    has_list_ = false;
  }
  /// A list of the row has this many numbers.
  void promise(std::uint64_t count) {
    promised_ += count;
    has_list_ = true;
  }
  void end_row() {
    if (binary()) return;
    std::size_t scanned = 0;
    bool in_word = false;
    for (int c = peek(); c >= 0 && !is_line_end(c); c = peek()) {
      if (++scanned > longest_gap) fail("the numbers of this row do not end its line");
      const bool word = c != ' ' && c != '\t';
      if (word && !in_word) ++numbers_;
      in_word = word;
      ++begin_;
    }
    if (numbers_ != promised_) fail_row();
    numbers_ = 0;
  }

  /// Warns of `unread` elements of the header, and of anything behind the last element.
  void warn_of_rest(std::span<const Element> unread) {
    const std::string more = binary() ? bytes_behind(unread) : lines_behind(unread);
    if (!more.empty())
      log::warning(fmt::format("{}: {} more than its header promises are left out", file_.name(), more));
  }

  [[noreturn]] void fail(const std::string& fault) const {
    throw bad_input(file_.name(), format_ == Format::ascii ? fmt::format("line {}: {}", line_, fault) : fault);
  }

 private:
  bool refill() {
    position_ += end_;
    begin_ = 0;
    end_ = static_cast<std::size_t>(std::min<std::uint64_t>(buffer_.size(), file_.size() - position_));
    if (end_ > 0) file_.read_at(position_, std::span(buffer_.data(), end_));
    return end_ > 0;
  }
  static bool is_line_end(int c) { return c == '\n' || c == '\r'; }

  [[noreturn]] void fail_row() const {
    fail(fmt::format("{}, {} {}", counted(numbers_, "number"),
                     has_list_ ? "the header and the lists in this line promise" : "the header promises", promised_));
  }

  std::string bytes_behind(std::span<const Element> unread) const {
    constexpr std::uint64_t line_end = 2;  // which some writers append
    std::uint64_t left = file_.size() - position_ - begin_;
    for (const Element& element : unread) {
      for (const Property& p : element.properties) {
        const std::size_t size = type_size[static_cast<std::size_t>(p.type)];
        if (p.count || element.count > left / size) return {};
        left -= element.count * size;
      }
    }
    return left > line_end ? counted(left, "byte") : "";
  }

  std::string lines_behind(std::span<const Element> unread) {
    std::uint64_t promised = 0, lines = 0, first = 0, scanned = 0;
    for (const Element& element : unread)
      promised += element.properties.empty() ? 0 : element.count;
    bool blank = true;
    int c = peek();
    for (; c >= 0 && scanned < longest_rest; ++scanned) {
      if (blank && c > ' ') {
        blank = false;
        if (++lines == promised + 1) first = line_;
      }
      if (is_line_end(c)) blank = true;
      if (c == line_end_) ++line_;
      ++begin_;
      c = peek();
    }
    if (first == 0) return {};
    return fmt::format("line {}: {}{}", first, c < 0 ? "" : "at least ", counted(lines - promised, "line"));
  }

  // The next byte, or -1 at the end of the file.
  int peek() { return begin_ < end_ || refill() ? buffer_[begin_] : -1; }

  double ascii_value(Type type) {
    std::size_t gap = 0;
    int c = peek();
    while (c == ' ' || c == '\t' || c == '\r' || c == '\n') {
      if (is_line_end(c) && numbers_ > 0) fail_row();
      if (c == line_end_) ++line_;
      if (++gap > longest_gap) fail("a number is missing");
      ++begin_;
      c = peek();
    }
    if (c < 0) fail("the file ends before all the elements of its header");
    std::array<char, longest_token> token;
    std::size_t length = 0;
    while (c > ' ') {
      if (length == token.size()) fail("a number is longer than 400 characters");
      token[length++] = static_cast<char>(c);
      ++begin_;
      c = peek();
    }
    ++numbers_;
    const std::string_view text(token.data(), length);
    double number = 0;
    const char* first = token.data() + (text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
    const char* last = token.data() + length;
    const auto [rest, fault] = std::from_chars(first, last, number);
    if (fault == std::errc::result_out_of_range && rest == last) {
      // from_chars does not store such numbers: too large for a double, or smaller than the smallest.
      number = std::strtod(std::string(text).c_str(), nullptr);
    } else if (fault != std::errc{} || rest != last) {
      fail(text::quoted(text) + " is not a number");
    }
    if (type != Type::f32 && type != Type::f64 && !fits(number, type))
      fail(text::quoted(text) + " does not fit its type");
    return number;
  }

  static bool fits(double number, Type type) {
    constexpr std::array<std::pair<double, double>, 6> range{
        {{-128, 127}, {0, 255}, {-32768, 32767}, {0, 65535}, {-2147483648.0, 2147483647.0}, {0, 4294967295.0}}};
    const auto& [low, high] = range[static_cast<std::size_t>(type)];
    return number >= low && number <= high && number == std::floor(number);
  }

  double binary_value(Type type) {
    std::array<unsigned char, 8> bytes{};
    const std::size_t size = type_size[static_cast<std::size_t>(type)];
    if (end_ - begin_ >= size) {
      std::memcpy(bytes.data(), buffer_.data() + begin_, size);
      begin_ += size;
    } else {
      for (std::size_t i = 0; i < size; ++i) {
        const int c = peek();
        if (c < 0) fail("the file ends before all the elements of its header");
        bytes[i] = static_cast<unsigned char>(c);
        ++begin_;
      }
    }
    if (format_ == Format::big) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case Type::i8:
        return as<std::int8_t>(bytes);
      case Type::u8:
        return as<std::uint8_t>(bytes);
      case Type::i16:
        return as<std::int16_t>(bytes);
      case Type::u16:
        return as<std::uint16_t>(bytes);
      case Type::i32:
        return as<std::int32_t>(bytes);
      case Type::u32:
        return as<std::uint32_t>(bytes);
      case Type::f32:
        return as<float>(bytes);
      case Type::f64:
        return as<double>(bytes);
    }
    return 0;
  }

  template <typename T>
  static double as(const std::array<unsigned char, 8>& bytes) {
    static_assert(std::endian::native == std::endian::little);
    T number;
    std::memcpy(&number, bytes.data(), sizeof number);
    return static_cast<double>(number);
  }

  const InputFile& file_;
  Format format_;
  std::uint64_t position_;  // of the buffer's first byte, in the file
  std::uint64_t line_;
  char line_end_;
  std::vector<unsigned char> buffer_ = std::vector<unsigned char>(1 << 18);
  std::size_t begin_ = 0, end_ = 0;
  std::uint64_t numbers_ = 0, promised_ = 0;  // of the row; 0 numbers: between rows
  bool has_list_ = false;
};

// The minimum size of the element's rows in bytes.
std::uint64_t smallest_row(const Header& header, const Element& element) {
  std::uint64_t bytes = 0;
  for (const Property& p : element.properties) {
    // In ascii, every value takes at least a digit and a separator.
    bytes += header.format == Format::ascii ? 2 : type_size[static_cast<std::size_t>(p.count.value_or(p.type))];
  }
  return bytes;
}

void check_counts(const InputFile& file, const Header& header) {
  // The last ascii value may lack its newline.
  std::uint64_t left = file.size() - header.bytes + (header.format == Format::ascii ? 1 : 0);
  for (const Element& element : header.elements) {
    const std::uint64_t row = smallest_row(header, element);
    if (row > 0 && element.count > left / row) {
      throw bad_input(file.name(), fmt::format("its header promises {} of element {}, but the file has only {} bytes",
                                               element.count, text::quoted(element.name), file.size()));
    }
    left -= row * element.count;
  }
}

class Body {
 public:
  Body(const InputFile& file, const Header& header) : file_(file), reader_(file, header) {}

  void skip(const Element& element) {
    if (element.properties.empty()) return;
    const bool lists = std::any_of(element.properties.begin(), element.properties.end(),
                                   [](const Property& p) { return p.count.has_value(); });
    if (reader_.binary() && !lists) {
      for (const Property& p : element.properties)
        reader_.leap(p.type, element.count);
      return;
    }
    if (element.count > most_vertices) {
      throw bad_input(file_.name(), fmt::format("has {} elements of the kind {}; palpa reads at most {}", element.count,
                                                text::quoted(element.name), most_vertices));
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      reader_.begin_row(element);
      for (const Property& p : element.properties)
        skip(p);
      reader_.end_row();
    }
  }

  void vertices(const Element& element) {
    std::array<int, 3> place{-1, -1, -1};
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Property& p = element.properties[i];
      if (p.count || p.name.size() != 1 || p.name[0] < 'x' || p.name[0] > 'z') continue;
      int& known = place[static_cast<std::size_t>(p.name[0] - 'x')];
      if (known >= 0) throw bad_input(file_.name(), "element \"vertex\" has property \"" + p.name + "\" twice");
      known = static_cast<int>(i);
    }
    if (place[0] < 0 || place[1] < 0 || place[2] < 0) {
      throw bad_input(file_.name(), "element \"vertex\" lacks one of the properties x, y, z");
    }
    if (element.count > most_vertices) {
      throw bad_input(file_.name(),
                      fmt::format("has {} vertices; palpa reads at most {}", element.count, most_vertices));
    }
    ply.positions.reserve(element.count);
    for (std::uint64_t row = 0; row < element.count; ++row) {
      Vec3 position(0);
      reader_.begin_row(element);
      for (std::size_t i = 0; i < element.properties.size(); ++i) {
        const Property& p = element.properties[i];
        if (p.count) {
          skip(p);
          continue;
        }
        const double value = reader_.value(p.type);
        for (int axis = 0; axis < 3; ++axis) {
          if (place[static_cast<std::size_t>(axis)] == static_cast<int>(i)) position[axis] = value;
        }
      }
      reader_.end_row();
      if (!std::isfinite(position.x) || !std::isfinite(position.y) || !std::isfinite(position.z)) {
        reader_.fail(fmt::format("vertex {} is not finite: {}", row, text::point(position)));
      }
      ply.positions.push_back(position);
    }
  }

  void faces(const Element& element) {
    const auto list = std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
      return p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
    });
    if (list == element.properties.end()) {
      if (element.count == 0) return;
      throw bad_input(file_.name(), "element \"face\" lacks the list property vertex_indices");
    }
    if (list->type == Type::f32 || list->type == Type::f64) {
      throw bad_input(file_.name(), "the indices of element \"face\" are not whole numbers by their type");
    }
    for (std::uint64_t row = 0; row < element.count; ++row) {
      reader_.begin_row(element);
      for (auto p = element.properties.begin(); p != element.properties.end(); ++p) {
        if (p == list) {
          polygon(row, *p);
        } else {
          skip(*p);
        }
      }
      reader_.end_row();
    }
  }

  void warn_of_rest(std::span<const Element> unread) { reader_.warn_of_rest(unread); }

  // Needed at the end, because faces may come before vertices.
  void check_indices() const {
    for (std::size_t t = 0; t < ply.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        if (ply.triangles[t][i] >= ply.positions.size()) {
          throw bad_input(file_.name(), fmt::format("a face uses vertex {}, but there are only {}", ply.triangles[t][i],
                                                    ply.positions.size()));
        }
      }
    }
  }

  Ply ply;

 private:
  std::uint64_t list_length(const Property& p) {
    const double count = reader_.value(*p.count);
    if (count < 0) reader_.fail(fmt::format("a list has a negative count, {}", count));
    reader_.promise(static_cast<std::uint64_t>(count));
    return static_cast<std::uint64_t>(count);
  }
  void skip(const Property& p) {
    const std::uint64_t count = p.count ? list_length(p) : 1;
    if (reader_.binary()) {
      reader_.leap(p.type, count);
      return;
    }
    for (std::uint64_t i = 0; i < count; ++i)
      reader_.value(p.type);
  }
  void polygon(std::uint64_t row, const Property& p) {
    const std::uint64_t corners = list_length(p);
    if (corners < 3 || corners > most_corners) {
      reader_.fail(fmt::format("face {} has {} corners; a face has 3 to {}", row, corners, most_corners));
    }
    if (ply.triangles.size() + corners - 2 > most_triangles) {
      reader_.fail(fmt::format("more than {} triangles; palpa reads no more", most_triangles));
    }
    glm::uvec3 t(0);  // one by one, because the evaluation order of arguments is unspecified
    t[0] = index(row, p);
    t[1] = index(row, p);
    for (std::uint64_t i = 2; i < corners; ++i) {
      t[2] = index(row, p);
      ply.triangles.push_back(t);
      t[1] = t[2];
    }
  }
  std::uint32_t index(std::uint64_t row, const Property& p) {
    const double value = reader_.value(p.type);
    if (value < 0) reader_.fail(fmt::format("face {} uses vertex {}", row, value));
    return static_cast<std::uint32_t>(value);
  }

  const InputFile& file_;
  Reader reader_;
};

}  // namespace

Ply read_ply(const std::filesystem::path& path) {
  const InputFile file(path);
  const Header header = parse_header(file);
  check_counts(file, header);
  Body body(file, header);
  std::size_t wanted = 0, vertex_elements = 0, face_elements = 0;
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    vertex_elements += header.elements[i].name == "vertex" ? 1 : 0;
    face_elements += header.elements[i].name == "face" ? 1 : 0;
    if (header.elements[i].name == "vertex" || header.elements[i].name == "face") wanted = i + 1;
  }
  if (vertex_elements != 1 || face_elements > 1) {
    throw bad_input(file.name(), vertex_elements == 0 ? "has no element \"vertex\"" : "has an element twice");
  }
  // Data behind the last wanted element need not be read.
  for (std::size_t i = 0; i < wanted; ++i) {
    const Element& element = header.elements[i];
    if (element.name == "vertex") {
      body.vertices(element);
    } else if (element.name == "face") {
      body.faces(element);
    } else {
      body.skip(element);
    }
  }
  body.check_indices();
  body.warn_of_rest(std::span(header.elements).subspan(wanted));
  return std::move(body.ply);
}

}  // namespace palpa::geometry
