// JSON of an untrusted file: bounded parsing, and type-checked access to members.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpa::geometry::gltf {

using Json = nlohmann::json;

/// A parsed document. Strings of more than 4 KiB (mostly buffers as data URIs) are replaced by short placeholders,
/// because the parser would spend a tenth of a microsecond on each of their bytes.
class Parsed {
 public:
  /// `text` must outlive it. Throws bad_input: a syntax error (with its line), nesting beyond 128 levels, more than two
  /// million values.
  Parsed(const std::string& file, const std::string& text);
  Parsed(const Parsed&) = delete;
  Parsed& operator=(const Parsed&) = delete;

  const Json& json() const { return json_; }
  /// The original string, if `value` is a placeholder for a long one.
  std::string whole(const std::string& value) const;

 private:
  Json json_;
  std::vector<std::string_view> long_strings_;  // into the text
};

/// An object of the document with its name for messages, e.g. "accessor 3". All values that are read from it (not those
/// of json() and array()) also go into a reduced copy of the document, if there is one: checked, and whole numbers in
/// their plain form (28 for 28.0).
class Item {
 public:
  /// `reduced` is this object in the copy; nullptr: none. Throws bad_input unless `value` is an object.
  Item(const std::string& file, const Json& value, std::string where, Json* reduced = nullptr);

  const Json& json() const { return *value_; }
  const std::string& where() const { return where_; }
  const std::string& file() const { return *file_; }

  /// Throws bad_input "<where>: <fault>".
  [[noreturn]] void fail(const std::string& fault) const;

  void warn(const std::string& text) const;

  /// Writes a member into the copy; returns the value.
  template <typename T>
  const T& write(const char* key, const T& value) const {
    if (reduced_ != nullptr) (*reduced_)[key] = value;
    return value;
  }

  /// Empties this object in the copy.
  void forget() const {
    if (reduced_ != nullptr) reduced_->clear();
  }
  /// From now on, nothing that is read from it, or from its members, goes into the copy.
  void stop_writing() { reduced_ = nullptr; }

  bool has(const char* key) const { return value_->contains(key); }
  /// A whole number in [least, most]; nullopt if absent.
  std::optional<std::uint64_t> whole(const char* key, std::uint64_t least, std::uint64_t most) const;
  std::uint64_t needed_whole(const char* key, std::uint64_t least, std::uint64_t most) const {
    return needed(key, whole(key, least, most));
  }
  /// An index into a collection of `count` elements.
  std::optional<std::uint32_t> index(const char* key, const char* collection, std::size_t count) const;
  std::uint32_t needed_index(const char* key, const char* collection, std::size_t count) const {
    return needed(key, index(key, collection, count));
  }
  /// Distinct indices; empty if absent.
  std::vector<std::uint32_t> indices(const char* key, const char* collection, std::size_t count) const;
  /// Exactly `count` finite numbers; nullopt if absent.
  std::optional<std::vector<double>> numbers(const char* key, std::size_t count) const;
  std::optional<std::string> string(const char* key) const;
  std::optional<bool> boolean(const char* key) const;
  /// A member that is an object.
  std::optional<Item> item(const char* key) const;
  Item needed_item(const char* key) const { return needed(key, item(key)); }
  /// A member that is an array; nullptr if absent.
  const Json* array(const char* key) const;
  /// The length of such an array; 0 if absent.
  std::size_t size(const char* key) const;
  /// An object in such an array, called e.g. "accessor 3" for messages.
  Item element(const char* key, const std::string& name, std::size_t index) const;
  /// Whether the object has the extension.
  bool has_extension(const char* name) const;

 private:
  template <typename T>
  T needed(const char* key, std::optional<T> value) const {
    if (!value) fail(std::string("\"") + key + "\" is missing");
    return *std::move(value);
  }
  std::uint64_t checked_index(const Json& value, const char* key, const char* collection, std::size_t count) const;

  const std::string* file_;
  const Json* value_;
  Json* reduced_;
  std::string where_;
};

}  // namespace palpa::geometry::gltf
