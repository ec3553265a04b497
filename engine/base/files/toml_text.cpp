// Work that needs no parser: limits on text before it is read, and text to be written.
#include <fmt/format.h>

#include "base/files/toml.hpp"

namespace palpa {
namespace {

/// Walks over TOML text and distinguishes structural characters from the content of strings and comments. Text that is
/// not TOML may confuse it, but the parser stops at the same place, before it nests anything behind it.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool done() const { return at_ >= text_.size(); }
  std::uint64_t line() const { return line_; }

  /// The next structural character. Strings and comments are skipped and yield '"' and '\n'.
  char next() {
    const char c = text_[at_];
    if (c == '#') {
      while (!done() && text_[at_] != '\n')
        ++at_;
      return ' ';
    }
    if (c == '"' || c == '\'') {
      skip_string(c);
      return '"';
    }
    ++at_;
    if (c == '\n') ++line_;
    return c;
  }

 private:
  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multi_line = text_.substr(at_, 3) == triple;
    at_ += multi_line ? 3 : 1;
    while (!done()) {
      const char c = text_[at_];
      if (c == '\\' && quote == '"') {
        // The escaped character may be a line break; count it.
        if (at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++line_;
        at_ += 2;
      } else if (!multi_line && (c == quote || c == '\n')) {
        if (c == quote) ++at_;
        return;
      } else if (multi_line && text_.substr(at_, 3) == triple) {
        at_ += 3;
        // Up to two more quotes belong to the end of the string.
        for (int more = 0; more < 2 && !done() && text_[at_] == quote; ++more)
          ++at_;
        return;
      } else {
        if (c == '\n') ++line_;
        ++at_;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 1;
};

}  // namespace

void guard_toml(std::string_view text, const std::string& file, const TomlLimits& limits) {
  if (text.size() > limits.bytes) {
    throw bad_input(file, fmt::format("has {} bytes, at most {} are expected", text.size(), limits.bytes));
  }
  Scanner scanner(text);
  std::uint64_t items = 0;
  std::uint32_t parts = 1;
  while (!scanner.done()) {
    switch (scanner.next()) {
      case '.':
        if (++parts > limits.key_parts) {
          throw bad_input(file, fmt::format("line {}: a key of more than {} parts", scanner.line(), limits.key_parts));
        }
        break;
      case '\n':
      case ',':
      case '[':
      case '{':
      case '=':
        parts = 1;
        if (++items > limits.items) {
          throw bad_input(file, fmt::format("line {}: more than {} values and lines", scanner.line(), limits.items));
        }
        break;
      default:
        break;
    }
  }
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  // "3" would read back as an integer, and "-0" as an integer without its sign.
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

std::string toml_pose(const Transform& pose) {
  std::string text = "[";
  for (int row = 0; row < 4; ++row) {
    text += row == 0 ? "[" : ",\n  [";
    for (int column = 0; column < 4; ++column) {
      text += (column == 0 ? "" : ", ") + toml_number(pose[column][row]);
    }
    text += "]";
  }
  return text + "]";
}

}  // namespace palpa
