// JSON of a file that nobody vouches for: bounded parsing, and members read with their types checked.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::geometry::gltf {

using Json = nlohmann::json;

/// A parsed document. Strings of more than 4 KiB (buffers as data URIs, mostly) are replaced by short ones that stand
/// for them: the parser would spend a tenth of a microsecond on each of their bytes.
class Parsed {
 public:
  /// `text` must outlive it. Throws bad_input: a syntax error (its line), nesting beyond 128 levels, more than two
  /// million values.
  Parsed(const std::string& file, const std::string& text);
  Parsed(const Parsed&) = delete;
  Parsed& operator=(const Parsed&) = delete;

  const Json& json() const { return json_; }
  /// The string itself, if `value` stands for a long one.
  std::string whole(const std::string& value) const;
  /// The same for a name, whose escapes are resolved.
  std::string whole_name(const std::string& value) const;

 private:
  std::optional<std::string_view> long_string(const std::string& value) const;

  Json json_;
  std::vector<std::string_view> long_strings_;  // into the text
};

/// An object of the document with its name for messages, e.g. "accessor 3".
class Item {
 public:
  /// Throws bad_input unless `value` is an object.
  Item(const std::string& file, const Json& value, std::string where);

  const Json& json() const { return *value_; }
  const std::string& where() const { return where_; }
  const std::string& file() const { return *file_; }

  /// bad_input "<where>: <fault>".
  [[noreturn]] void fail(const std::string& fault) const;

  bool has(const char* key) const { return value_->contains(key); }
  /// A whole number in [least, most]; nullopt where absent.
  std::optional<std::uint64_t> whole(const char* key, std::uint64_t least, std::uint64_t most) const;
  std::uint64_t needed_whole(const char* key, std::uint64_t least, std::uint64_t most) const;
  /// An index into a collection of `count`.
  std::optional<std::uint32_t> index(const char* key, const char* collection, std::size_t count) const;
  std::uint32_t needed_index(const char* key, const char* collection, std::size_t count) const;
  /// Distinct indices; empty where absent.
  std::vector<std::uint32_t> indices(const char* key, const char* collection, std::size_t count) const;
  /// Exactly `count` finite numbers; nullopt where absent.
  std::optional<std::vector<double>> numbers(const char* key, std::size_t count) const;
  std::optional<std::string> string(const char* key) const;
  /// A member that is an object.
  std::optional<Item> item(const char* key) const;
  Item needed_item(const char* key) const;
  /// A member that is an array; nullptr where absent.
  const Json* array(const char* key) const;
  /// Whether the object carries the extension.
  bool has_extension(const char* name) const;

 private:
  std::uint64_t checked_index(const Json& value, const char* key, const char* collection, std::size_t count) const;

  const std::string* file_;
  const Json* value_;
  std::string where_;
};

}  // namespace palpa::geometry::gltf
