#include "geometry/files/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/error.hpp"
#include "base/units.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::ply {
namespace {

constexpr std::size_t longest_header = 64 << 10;

std::optional<Type> parse_type(std::string_view name) {
  constexpr std::pair<std::string_view, Type> names[]{
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  for (const auto& [text, type] : names) {
    if (text == name) return type;
  }
  return std::nullopt;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

// One line of the header, after the first two.
class HeaderLine {
 public:
  HeaderLine(const std::string& file, std::uint64_t number, std::string_view line)
      : file_(file), number_(number), line_(line), words_(words_of(line)) {}

  const std::vector<std::string_view>& words() const { return words_; }
  [[noreturn]] void fail(const std::string& fault) const {
    throw bad_input(file_, fmt::format("line {}: {}: {}", number_, text::quoted(line_), fault));
  }

  Element element() const {
    if (words_.size() != 3) fail("an element line must be \"element NAME COUNT\"");
    const std::optional count = parse_whole<decltype(Element::count)>(words_[2]);
    if (!count) fail("the count is not a whole number");
    return {std::string(words_[1]), *count, {}};
  }
  Property property() const {
    Property property;
    const bool list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (list ? 5U : 3U))
      fail("a property line must be \"property TYPE NAME\" or \"property list TYPE TYPE NAME\"");
    const auto type = parse_type(words_[list ? 3 : 1]);
    if (!type) fail("unknown type");
    if (list) {
      property.count = parse_type(words_[2]);
      if (!property.count || *property.count == Type::f32 || *property.count == Type::f64)
        fail("a list's count must be an integer");
    }
    property.type = *type;
    property.name = words_.back();
    return property;
  }
  Format format() const {
    if (words_.size() != 3 || words_[2] != "1.0")
      fail("a format line must be \"format ascii|binary_little_endian|binary_big_endian 1.0\"");
    if (words_[1] == "ascii") return Format::ascii;
    if (words_[1] == "binary_little_endian") return Format::little;
    if (words_[1] == "binary_big_endian") return Format::big;
    fail("unknown format");
  }

 private:
  const std::string& file_;
  std::uint64_t number_;
  std::string_view line_;
  std::vector<std::string_view> words_;
};

}  // namespace

Header parse_header(const InputFile& file) {
  const std::string& name = file.name();
  std::string text = file.head(longest_header);
  const std::size_t mark = text.size() - text_in(text, name).size();
  text.erase(0, mark);
  if (!text.starts_with("ply") || (text.size() > 3 && text[3] != '\n' && text[3] != '\r')) {
    throw bad_input(name, "is not a PLY file: its first line is not \"ply\"");
  }
  Header header;
  // Some writers end lines with only a carriage return. The first line shows this; in a binary body, any byte may
  // follow.
  if (text.size() > 4 && text[3] == '\r' && text[4] != '\n') header.line_end = '\r';
  bool has_format = false;
  std::size_t at = 0;
  for (;;) {
    const std::size_t end = text.find(header.line_end, at);
    if (end == std::string::npos) {
      throw bad_input(name, mark + text.size() == longest_header
                                ? "its header is longer than 64 KiB (lines end with a newline)"
                                : "its header has no \"end_header\"");
    }
    std::string_view line(text.data() + at, end - at);
    if (line.ends_with('\r')) line.remove_suffix(1);
    at = end + 1;
    const HeaderLine here(name, ++header.lines, line);
    const auto& words = here.words();
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info" || header.lines == 1) continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format") {
      header.format = here.format();
      has_format = true;
    } else if (words[0] == "element") {
      header.elements.push_back(here.element());
    } else if (words[0] == "property") {
      if (header.elements.empty()) here.fail("a property must come after its element");
      header.elements.back().properties.push_back(here.property());
    } else {
      here.fail("unknown keyword");
    }
  }
  if (!has_format) throw bad_input(name, "its header has no \"format\" line");
  header.bytes = mark + at;
  return header;
}

}  // namespace palpa::geometry::ply
