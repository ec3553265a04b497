#include "geometry/gltf_document/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/units.hpp"
#include "geometry/text.hpp"

namespace palpa::geometry::gltf {
namespace {

constexpr int deepest = 128;
constexpr std::size_t longest_string = 4096;
constexpr std::string_view long_string_mark = "data:long string ";
constexpr std::size_t most_values = 2'000'000;  // about 80 bytes each

// The value as a whole number: JSON writers may write 28 or 28.0.
std::optional<std::uint64_t> as_whole(const Json& value) {
  if (value.is_number_unsigned() || value == 0) return value.get<std::uint64_t>();  // -0 is 0, too
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (number >= 0 && number <= 9007199254740992.0 && number == std::floor(number))
      return static_cast<std::uint64_t>(number);
  }
  return std::nullopt;
}

// The position of the quote that ends the string whose text begins at `from`; text.size() if there is none.
std::size_t end_of_string(const std::string& text, std::size_t from) {
  for (std::size_t quote = text.find('"', from); quote != std::string::npos; quote = text.find('"', quote + 1)) {
    std::size_t escapes = 0;
    while (quote - escapes > from && text[quote - escapes - 1] == '\\')
      ++escapes;
    if (escapes % 2 == 0) return quote;
  }
  return text.size();
}

// One pass over the raw text, before anything is built from it: counts values and takes out long strings. (The parser's
// own callback could count, but its cost grows with the square of an array's length.)
std::string shortened(const std::string& file, const std::string& text, std::vector<std::string_view>& long_strings) {
  std::string out;
  int depth = 0;
  std::size_t values = 1, copied = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      const std::size_t end = end_of_string(text, i + 1);
      if (end - i > longest_string && end < text.size()) {
        out.append(text, copied, i + 1 - copied).append(long_string_mark).append(std::to_string(long_strings.size()));
        long_strings.push_back(std::string_view(text).substr(i + 1, end - i - 1));
        copied = end;
      }
      i = end;
    } else if (c == '[' || c == '{') {
      ++values;
      if (++depth > deepest) throw bad_input(file, fmt::format("its JSON is nested more than {} levels deep", deepest));
    } else if (c == ']' || c == '}') {
      --depth;
    } else if (c == ',' || c == ':') {
      ++values;
    }
  }
  if (values > most_values) throw bad_input(file, fmt::format("its JSON has more than {} values", most_values));
  return out.append(text, copied);
}

}  // namespace

Parsed::Parsed(const std::string& file, const std::string& text) {
  const std::string brief = shortened(file, text, long_strings_);
  try {
    json_ = Json::parse(brief);
  } catch (const Json::parse_error& e) {
    // The exception's own text quotes the input, which may be endless and contain anything.
    const std::size_t end = std::min(e.byte, brief.size());
    const bool one_line = brief.find('\n') == std::string::npos && brief.size() == text.size();
    const auto line = std::count(brief.begin(), brief.begin() + static_cast<std::ptrdiff_t>(end), '\n') + 1;
    throw bad_input(file, one_line ? fmt::format("its JSON has a syntax error at character {}", end)
                                   : fmt::format("its JSON has a syntax error at line {}", line));
  } catch (const Json::exception&) {
    throw bad_input(file, "its JSON has a number that is out of range");
  }
}

std::string Parsed::whole(const std::string& value) const {
  if (!value.starts_with(long_string_mark)) return value;
  const auto index = parse_whole<std::size_t>(std::string_view(value).substr(long_string_mark.size()));
  if (!index || *index >= long_strings_.size()) return value;
  const std::string_view raw = long_strings_[*index];
  // Data URIs need no parser, which would take its time; only some writers put "\/" into base64.
  if (std::ranges::all_of(raw, [](char c) { return c >= ' ' && c < 0x7f && c != '\\'; })) return std::string(raw);
  const Json text = Json::parse(fmt::format("\"{}\"", raw), nullptr, false);
  return text.is_string() ? text.get<std::string>() : value;
}

Item::Item(const std::string& file, const Json& value, std::string where, Json* reduced)
    : file_(&file), value_(&value), reduced_(reduced), where_(std::move(where)) {
  if (!value.is_object()) fail("is not a JSON object");
  if (reduced != nullptr && !reduced->is_object()) *reduced = Json::object();
}

void Item::fail(const std::string& fault) const {
  throw bad_input(*file_, where_ + ": " + fault);
}

void Item::warn(const std::string& text) const {
  log::warning(fmt::format("{}: {}: {}", *file_, where_, text));
}

std::optional<std::uint64_t> Item::whole(const char* key, std::uint64_t least, std::uint64_t most) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  const auto number = as_whole(*found);
  if (!number) fail(fmt::format("\"{}\" is not a whole number", key));
  if (*number < least || *number > most)
    fail(fmt::format("\"{}\" is {}; it must lie within {} and {}", key, *number, least, most));
  return write(key, *number);
}

std::uint64_t Item::checked_index(const Json& value, const char* key, const char* collection, std::size_t count) const {
  const auto number = as_whole(value);
  if (!number) fail(fmt::format("\"{}\" is not an index", key));
  if (*number >= count) fail(fmt::format("\"{}\" names {} {}, but the file has {}", key, collection, *number, count));
  return *number;
}

std::optional<std::uint32_t> Item::index(const char* key, const char* collection, std::size_t count) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return write(key, static_cast<std::uint32_t>(checked_index(*found, key, collection, count)));
}

std::vector<std::uint32_t> Item::indices(const char* key, const char* collection, std::size_t count) const {
  std::vector<std::uint32_t> result;
  const Json* list = array(key);
  if (list == nullptr) return result;
  result.reserve(list->size());
  for (const Json& value : *list)
    result.push_back(static_cast<std::uint32_t>(checked_index(value, key, collection, count)));
  std::vector<std::uint32_t> sorted = result;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) fail(fmt::format("\"{}\" names {} {} twice", key, collection, *twice));
  write(key, result);
  return result;
}

std::optional<std::vector<double>> Item::numbers(const char* key, std::size_t count) const {
  const Json* list = array(key);
  if (list == nullptr) return std::nullopt;
  if (list->size() != count) fail(fmt::format("\"{}\" has {} values; it needs {}", key, list->size(), count));
  std::vector<double> result;
  result.reserve(count);
  for (const Json& value : *list) {
    if (!value.is_number()) fail(fmt::format("\"{}\" holds something that is not a number", key));
    result.push_back(value.get<double>());
    if (!std::isfinite(result.back())) fail(fmt::format("\"{}\" holds a number that is not finite", key));
  }
  write(key, result);
  return result;
}

std::optional<std::string> Item::string(const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  if (!found->is_string()) fail(fmt::format("\"{}\" is not a string", key));
  return write(key, found->get_ref<const std::string&>());
}

std::optional<bool> Item::boolean(const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  if (!found->is_boolean()) fail(fmt::format("\"{}\" is neither true nor false", key));
  return write(key, found->get<bool>());
}

std::optional<Item> Item::item(const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return std::nullopt;
  return Item(*file_, *found, where_ + ", " + key, reduced_ == nullptr ? nullptr : &(*reduced_)[key]);
}

const Json* Item::array(const char* key) const {
  const auto found = value_->find(key);
  if (found == value_->end()) return nullptr;
  if (!found->is_array()) fail(fmt::format("\"{}\" is not an array", key));
  return &*found;
}

std::size_t Item::size(const char* key) const {
  const Json* list = array(key);
  return list == nullptr ? 0 : list->size();
}

Item Item::element(const char* key, const std::string& name, std::size_t index) const {
  const Json& list = *array(key);
  Json* reduced = reduced_ == nullptr ? nullptr : &(*reduced_)[key];
  if (reduced != nullptr && !reduced->is_array()) *reduced = Json::array_t(list.size(), Json::object());
  return {*file_, list[index], fmt::format("{} {}", name, index), reduced == nullptr ? nullptr : &(*reduced)[index]};
}

bool Item::has_extension(const char* name) const {
  const auto found = value_->find("extensions");
  return found != value_->end() && found->is_object() && found->contains(name);
}

}  // namespace palpa::geometry::gltf
