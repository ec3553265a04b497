// JSON text with numbers that round-trip: each is the shortest decimal of its own type, so a float prints as 0.1 and
// not as the nearest double.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpa {

/// Writes a document front to back. Objects and arrays open and close in pairs; keys keep the order in which they are
/// written. Non-finite numbers become null, because JSON cannot express them. Invalid UTF-8 becomes U+FFFD.
///
/// A writer that is cleared and reused allocates nothing once its text has grown.
class JsonWriter {
 public:
  /// The layout of a container. Everything inside a container other than `block` stays on one line.
  enum class Style {
    block,    ///< one member per line, indented by two more spaces
    line,     ///< [1, 2]
    compact,  ///< [1,2], including everything inside
    rows,     ///< one member per line without further indentation, each of them compact
  };

  JsonWriter& begin_object(Style style = Style::block) { return begin('{', style); }
  JsonWriter& end_object() { return end('}'); }
  JsonWriter& begin_array(Style style = Style::line) { return begin('[', style); }
  JsonWriter& end_array() { return end(']'); }
  JsonWriter& key(std::string_view name);

  JsonWriter& value(double number);
  /// Rounded to `digits` significant digits.
  JsonWriter& rounded(double number, int digits);
  JsonWriter& value(float number);
  JsonWriter& value(std::int64_t number);
  JsonWriter& value(std::uint64_t number);
  JsonWriter& value(std::uint32_t number) { return value(std::uint64_t{number}); }
  JsonWriter& value(int number) { return value(std::int64_t{number}); }
  JsonWriter& value(bool truth);
  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& null();

  JsonWriter& value(const glm::vec3& v);
  JsonWriter& value(const glm::dvec3& v);
  template <typename T>
  JsonWriter& value(std::span<const T> numbers) {
    begin_array();
    for (const T& number : numbers)
      value(number);
    return end_array();
  }
  template <typename T>
  JsonWriter& value(const std::vector<T>& numbers) {
    return value(std::span<const T>(numbers));
  }

  /// Null if there is none.
  template <typename T>
  JsonWriter& value(const std::optional<T>& number) {
    return number ? value(*number) : null();
  }

  template <typename T>
  JsonWriter& member(std::string_view name, const T& v) {
    key(name);
    return value(v);
  }

  /// Ends the document with a newline. Every container must be closed. Valid until the writer is used again.
  std::string_view finish();
  /// Like finish(), but returns the text itself.
  std::string take();
  /// Starts a new document and keeps the storage.
  void clear();

 private:
  JsonWriter& begin(char open, Style style);
  JsonWriter& end(char close);
  void separate();
  void quote(std::string_view text);

  struct Level {
    Style style;
    bool empty;
  };
  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace palpa
