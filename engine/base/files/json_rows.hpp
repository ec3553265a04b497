// The members of a JSON object as one list, in their order: its text and the paths of its values both come from it, so
// that neither has what the other lacks.
//
//   JsonRows<Result> rows;
//   rows.value("frequency_hz", [](const Result& r) { return r.frequency; })
//       .value("aimed_m", [](const Result& r) { return r.aimed.empty() ? nullptr : &r.aimed; })
//       .objects("nulls", rows_of_nulls, [](const Result& r) { return r.nulls ? &r.nulls->places : nullptr; });
#pragma once

#include <concepts>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/files/json_writer.hpp"

namespace palpa {

/// The members of a T. A function gets each of them from the T. If it gives a pointer or an optional that is empty, the
/// member is left out.
template <typename T>
class JsonRows {
 public:
  using Style = JsonWriter::Style;

  /// A number, a text or a place; a range of such, with null for each optional that is empty; or a range of these
  /// ranges.
  template <typename Get>
  JsonRows& value(std::string_view name, Get get) {
    using Value = Got<Get>;
    rows_.push_back(
        {{std::string(name) + entries<Value>()}, [key = std::string(name), get](JsonWriter& json, const T& from) {
           with(get(from), [&](const auto& value) { write_value(json.key(key), value); });
         }});
    return *this;
  }

  /// An object with rows of its own.
  template <typename U, typename Get>
  JsonRows& object(std::string_view name, const JsonRows<U>& rows, Get get, Style style = Style::block) {
    rows_.push_back({rows.paths(std::string(name) + "."),
                     [key = std::string(name), rows, get, style](JsonWriter& json, const T& from) {
                       with(get(from), [&](const U& one) { rows.write(json.key(key), one, style); });
                     }});
    return *this;
  }

  /// A list of such objects.
  template <typename U, typename Get>
  JsonRows& objects(std::string_view name, const JsonRows<U>& rows, Get get, Style style = Style::line) {
    rows_.push_back({rows.paths(std::string(name) + ".#."),
                     [key = std::string(name), rows, get, style](JsonWriter& json, const T& from) {
                       with(get(from), [&](const auto& all) {
                         json.key(key).begin_array(style);
                         for (const U& one : all)
                           rows.write(json, one);
                         json.end_array();
                       });
                     }});
    return *this;
  }

  /// The members of other rows, in this object.
  template <typename U, typename Get>
  JsonRows& members(const JsonRows<U>& rows, Get get) {
    rows_.push_back({rows.paths(), [rows, get](JsonWriter& json, const T& from) {
                       with(get(from), [&](const U& one) { rows.write_members(json, one); });
                     }});
    return *this;
  }

  /// Members that a function writes itself, with the paths of their values. Without paths, they say how the result came
  /// about rather than what it is: times, and what computed.
  JsonRows& written(std::vector<std::string> paths, std::function<void(JsonWriter&, const T&)> write) {
    rows_.push_back({std::move(paths), std::move(write)});
    return *this;
  }

  /// The members alone, into an object that has begun.
  void write_members(JsonWriter& json, const T& from) const {
    for (const Row& row : rows_)
      row.write(json, from);
  }
  /// The object.
  void write(JsonWriter& json, const T& from, Style style = Style::block) const {
    json.begin_object(style);
    write_members(json, from);
    json.end_object();
  }
  std::string text(const T& from) const {
    JsonWriter json;
    write(json, from);
    return json.take();
  }

  /// The paths of all single values, as of a member of `before`: names with dots between them, and # for the index of
  /// an entry of a list.
  std::vector<std::string> paths(const std::string& before = {}) const {
    std::vector<std::string> all;
    for (const Row& row : rows_) {
      for (const std::string& path : row.paths)
        all.push_back(before + path);
    }
    return all;
  }

 private:
  struct Row {
    std::vector<std::string> paths;
    std::function<void(JsonWriter&, const T&)> write;
  };

  template <typename V>
  static constexpr bool may_be_empty = requires(const V& given) {
    static_cast<bool>(given);
    *given;
  };
  /// What a function gives, without the pointer or the optional.
  template <typename Get, typename Given = std::remove_cvref_t<std::invoke_result_t<Get, const T&>>>
  static decltype(auto) got(const Given& given) {
    if constexpr (may_be_empty<Given>) {
      return *given;
    } else {
      return given;
    }
  }
  template <typename Get>
  using Got = std::remove_cvref_t<decltype(got<Get>(std::declval<std::invoke_result_t<Get, const T&>>()))>;
  template <typename V>
  static constexpr bool is_place = std::same_as<V, glm::vec3> || std::same_as<V, glm::dvec3>;
  template <typename V>
  static constexpr bool is_range = std::ranges::range<V> && !std::convertible_to<V, std::string_view>;

  template <typename V>
  static std::string entries() {
    if constexpr (is_place<V>) {
      return ".#";
    } else if constexpr (is_range<V>) {
      return ".#" + entries<std::remove_cvref_t<std::ranges::range_reference_t<V>>>();
    } else if constexpr (may_be_empty<V>) {
      return entries<std::remove_cvref_t<decltype(*std::declval<const V&>())>>();
    } else {
      return "";
    }
  }

  template <typename V>
  static void write_value(JsonWriter& json, const V& value) {
    if constexpr (is_range<V>) {
      json.begin_array();
      for (const auto& entry : value)
        write_value(json, entry);
      json.end_array();
    } else {
      json.value(value);
    }
  }

  template <typename V, typename Use>
  static void with(const V& value, const Use& use) {
    if constexpr (may_be_empty<V>) {
      if (value) use(*value);
    } else {
      use(value);
    }
  }

  std::vector<Row> rows_;
};

}  // namespace palpa
