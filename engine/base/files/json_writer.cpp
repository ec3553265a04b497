#include "base/files/json_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "base/text.hpp"

namespace palpa {

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (levels_.empty()) return;
  Level& level = levels_.back();
  if (!level.empty) {
    text_ += level.style == Style::line ? ", " : level.style == Style::rows ? ",\n " : ",";
  }
  level.empty = false;
  if (level.style == Style::block) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
  }
}

JsonWriter& JsonWriter::begin(char open, Style style) {
  separate();
  text_ += open;
  const Style outer = levels_.empty() ? Style::block : levels_.back().style;
  if (outer != Style::block) style = outer == Style::line ? Style::line : Style::compact;
  levels_.push_back({style, true});
  return *this;
}

JsonWriter& JsonWriter::end(char close) {
  const Level level = levels_.back();
  levels_.pop_back();
  if (level.style == Style::block && !level.empty) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
  }
  text_ += close;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  quote(name);
  const bool spaced = levels_.empty() || levels_.back().style == Style::block || levels_.back().style == Style::line;
  text_ += spaced ? ": " : ":";
  after_key_ = true;
  return *this;
}

JsonWriter& JsonWriter::value(double number) {
  if (!std::isfinite(number)) return null();
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", number);
  return *this;
}

JsonWriter& JsonWriter::rounded(double number, int digits) {
  if (!std::isfinite(number)) return null();
  separate();
  fmt::format_to(std::back_inserter(text_), "{:.{}g}", number, digits);
  return *this;
}

JsonWriter& JsonWriter::value(float number) {
  if (!std::isfinite(number)) return null();
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", number);
  return *this;
}

JsonWriter& JsonWriter::value(std::int64_t number) {
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", number);
  return *this;
}

JsonWriter& JsonWriter::value(std::uint64_t number) {
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", number);
  return *this;
}

JsonWriter& JsonWriter::value(bool truth) {
  separate();
  text_ += truth ? "true" : "false";
  return *this;
}

JsonWriter& JsonWriter::value(std::string_view text) {
  separate();
  quote(text);
  return *this;
}

JsonWriter& JsonWriter::null() {
  separate();
  text_ += "null";
  return *this;
}

JsonWriter& JsonWriter::value(const glm::vec3& v) {
  begin_array();
  value(v.x).value(v.y).value(v.z);
  return end_array();
}

JsonWriter& JsonWriter::value(const glm::dvec3& v) {
  begin_array();
  value(v.x).value(v.y).value(v.z);
  return end_array();
}

std::string_view JsonWriter::finish() {
  text_ += '\n';
  return text_;
}

std::string JsonWriter::take() {
  finish();
  std::string text = std::move(text_);
  clear();
  return text;
}

void JsonWriter::clear() {
  text_.clear();
  levels_.clear();
  after_key_ = false;
}

void JsonWriter::quote(std::string_view text) {
  text_ += '"';
  while (!text.empty()) {
    const unsigned char c = static_cast<unsigned char>(text.front());
    std::size_t length = 1;
    if (c == '"' || c == '\\') {
      text_ += '\\';
      text_ += text.front();
    } else if (c < 0x20 || c == 0x7f) {
      fmt::format_to(std::back_inserter(text_), "\\u{:04x}", c);
    } else if ((length = utf8_length(text)) != 0) {
      text_ += text.substr(0, length);
    } else {
      // A name from a file may contain any bytes; JSON may not.
      length = 1;
      text_ += "\\ufffd";
    }
    text.remove_prefix(length);
  }
  text_ += '"';
}

}  // namespace palpa
