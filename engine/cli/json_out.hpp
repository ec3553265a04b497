// JSON text with numbers that read back exactly: each is the shortest decimal of its own type, so a float prints as 0.1
// and not as the double nearest to it.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::cli {

/// Writes a document front to back. Objects and arrays open and close in pairs; keys keep the order they are written
/// in. Containers opened as `Style::line` stay on one line. Non-finite numbers become null, since JSON has no word for
/// them.
class JsonWriter {
 public:
  enum class Style { block, line };

  JsonWriter& begin_object(Style style = Style::block) { return begin('{', style); }
  JsonWriter& end_object() { return end('}'); }
  JsonWriter& begin_array(Style style = Style::line) { return begin('[', style); }
  JsonWriter& end_array() { return end(']'); }
  JsonWriter& key(std::string_view name);

  JsonWriter& value(double number);
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

  template <typename T>
  JsonWriter& member(std::string_view name, const T& v) {
    key(name);
    return value(v);
  }

  /// The document, ending in a newline. Every container must be closed.
  std::string take();

 private:
  JsonWriter& begin(char open, Style style);
  JsonWriter& end(char close);
  void separate();
  void quote(std::string_view text);

  struct Level {
    bool block;
    bool empty;
  };
  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

}  // namespace palpa::cli
