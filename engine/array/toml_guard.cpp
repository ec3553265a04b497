#include "array/toml_guard.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpa::array {
namespace {

/// Walks over TOML text and knows which characters are structure rather than content of strings and comments. Text that
/// is not TOML may confuse it; the parser stops there, too, before it nests anything behind that place.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  bool done() const { return at_ >= text_.size(); }
  std::uint64_t line() const { return line_; }

  /// The next structural character; strings and comments are passed over and yield '"' and '\n'.
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
        // Up to two quotes more belong to the string's end.
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

void guard_toml(std::string_view text, const std::string& file) {
  Scanner scanner(text);
  std::uint64_t items = 0;
  std::uint32_t parts = 1;
  while (!scanner.done()) {
    switch (scanner.next()) {
      case '.':
        if (++parts > max_key_parts) {
          throw bad_input(file, fmt::format("line {}: a key of more than {} parts", scanner.line(), max_key_parts));
        }
        break;
      case '\n':
      case ',':
      case '[':
      case '{':
      case '=':
        parts = 1;
        if (++items > max_toml_items) {
          throw bad_input(file, fmt::format("line {}: more than {} values and lines", scanner.line(), max_toml_items));
        }
        break;
      default:
        break;
    }
  }
}

std::string one_line(std::string_view message) {
  std::string line;
  for (const char c : message.substr(0, 200))
    line += c >= ' ' && c != '\x7f' ? c : '?';
  while (line.ends_with('.') || line.ends_with(' '))
    line.pop_back();
  return line;
}

}  // namespace palpa::array
