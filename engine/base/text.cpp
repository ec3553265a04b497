#include "base/text.hpp"

#include <fmt/format.h>

namespace palpa {
namespace {

/// The code point of a well-formed UTF-8 character.
unsigned code_point(std::string_view character) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
  if (character.size() == 1) return byte(0);
  unsigned code = byte(0) & (0x7fu >> character.size());
  for (std::size_t i = 1; i < character.size(); ++i)
    code = code << 6 | (byte(i) & 0x3fu);
  return code;
}

/// Controls, line and paragraph separators, characters that change the writing direction, the byte order mark.
bool is_unseen(unsigned code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069) || code == 0xfeff;
}

std::string escape(unsigned code) {
  if (code == '\n') return "\\n";
  if (code == '\r') return "\\r";
  if (code == '\t') return "\\t";
  return code < 0x80 ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
}

/// The start of the character at or before that byte.
std::size_t character_before(std::string_view text, std::size_t at) {
  while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80)
    --at;
  return at;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : (first & 0xf0) == 0xe0        ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  if (length == 3) {
    const unsigned code = (first & 0x0fu) << 12 | (byte(1) & 0x3fu) << 6 | (byte(2) & 0x3fu);
    if (code < 0x800 || (code >= 0xd800 && code < 0xe000)) return 0;
  }
  if (length == 4) {
    const unsigned code = (first & 0x07u) << 18 | (byte(1) & 0x3fu) << 12;
    if (code < 0x10000 || code > 0x10ffff) return 0;
  }
  return length;
}

std::string utf8(std::uint32_t code) {
  const auto byte = [](std::uint32_t value) { return static_cast<char>(value); };
  if (code < 0x80) return {byte(code)};
  if (code < 0x800) return {byte(0xc0 | code >> 6), byte(0x80 | (code & 63))};
  if (code < 0x10000) return {byte(0xe0 | code >> 12), byte(0x80 | (code >> 6 & 63)), byte(0x80 | (code & 63))};
  return {byte(0xf0 | code >> 18), byte(0x80 | (code >> 12 & 63)), byte(0x80 | (code >> 6 & 63)),
          byte(0x80 | (code & 63))};
}

std::uint64_t line_that_is_not_utf8(std::string_view text) {
  std::uint64_t line = 1;
  while (!text.empty()) {
    const auto c = static_cast<unsigned char>(text.front());
    const std::size_t length = c < 0x80 ? 1 : utf8_length(text);
    if (length == 0) return line;
    if (c == '\n') ++line;
    text.remove_prefix(length);
  }
  return 0;
}

std::string printable(std::string_view text, std::size_t most) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    std::string piece(text.substr(0, length));
    if (length == 0) {
      piece = fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    } else if (const unsigned code = code_point(piece); is_unseen(code)) {
      piece = escape(code);
    }
    if (shown.size() + piece.size() > most) return shown + "...";
    shown += piece;
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return shown;
}

std::string one_line(std::string_view message, std::size_t most) {
  const std::size_t last = message.find_last_not_of(" .\t\r\n");
  std::string line(message.substr(0, last == std::string_view::npos ? 0 : last + 1));
  for (char& c : line) {
    if (c == '\n' || c == '\r' || c == '\t') c = ' ';
  }
  return printable(line, most);
}

std::string shortened(const std::string& text, std::size_t most) {
  constexpr std::string_view gap = "...";
  if (text.size() <= most) return text;
  const std::size_t tail = (most - gap.size()) / 3;
  std::size_t from = text.size() - tail;
  while (from < text.size() && (static_cast<unsigned char>(text[from]) & 0xc0) == 0x80)
    ++from;
  const std::size_t head = character_before(text, most - gap.size() - tail);
  return text.substr(0, head).append(gap).append(text, from);
}

std::string counted(std::uint64_t n, std::string_view one) {
  return fmt::format("{} {}", n, plural(n, one));
}

std::string plural(std::uint64_t n, std::string_view one) {
  std::string word(one);
  if (n == 1) return word;
  const auto replace = [&](std::size_t letters, const char* ending) {
    word.resize(word.size() - letters);
    return word + ending;
  };
  if (word.ends_with("focus")) return replace(2, "i");
  if (word.ends_with("vertex")) return replace(2, "ices");
  if (word.ends_with('y') && !word.ends_with("ay") && !word.ends_with("ey")) return replace(1, "ies");
  const bool hisses = word.ends_with('s') || word.ends_with('x') || word.ends_with("ch") || word.ends_with("sh");
  return replace(0, hisses ? "es" : "s");
}

std::string first_is(std::string_view first, std::uint64_t count) {
  return count == 1 ? fmt::format("{} is", first) : fmt::format("{} and {} are", first, counted(count - 1, "other"));
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text)
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace palpa
