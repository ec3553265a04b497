#include "sweep/results.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/text.hpp"

namespace palpa::sweep {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 5> functions{"count", "min", "max", "mean", "sum"};

std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts(1);
  for (const char c : path) {
    if (c == '.') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

std::optional<std::size_t> index_of(const std::string& part) {
  std::size_t index = 0;
  const char* const end = part.data() + part.size();
  const auto [rest, fault] = std::from_chars(part.data(), end, index);
  if (fault != std::errc{} || rest != end) return std::nullopt;
  return index;
}

/// The shortest text that reads back as the same number.
std::string number_text(double number) {
  return std::isfinite(number) ? fmt::format("{}", number) : "null";
}

std::string text_of(const Json& value) {
  if (value.is_number_float()) return number_text(value.get<double>());
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// null for a list without numbers.
std::string made_of(const Json& list, std::string_view function) {
  if (function == "count") return fmt::format("{}", list.size());
  std::vector<double> numbers;
  for (const Json& item : list) {
    if (item.is_number()) numbers.push_back(item.get<double>());
  }
  if (numbers.empty()) return "null";
  if (function == "min") return number_text(*std::ranges::min_element(numbers));
  if (function == "max") return number_text(*std::ranges::max_element(numbers));
  double sum = 0;
  for (const double number : numbers)
    sum += number;
  return number_text(function == "sum" ? sum : sum / static_cast<double>(numbers.size()));
}

std::string fault_of_structure(const std::string& path, const std::string& entry) {
  return fmt::format("results: {} is {}; name one of its entries, such as {}.{}, or {}.count", shortened(path, 80),
                     entry == "0" ? "a list" : "an object", shortened(path, 80), shortened(entry, 40),
                     shortened(path, 80));
}

/// "fingers.#" for "fingers.3".
std::string without_indices(const std::string& path) {
  std::string text;
  for (const std::string& part : parts_of(path))
    text += (text.empty() ? "" : ".") + (index_of(part) ? "#" : part);
  return text;
}

std::string find(const Json& document, const std::string& path) {
  const Json* at = &document;
  const std::vector<std::string> parts = parts_of(path);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& part = parts[i];
    const bool last = i + 1 == parts.size();
    if (at->is_object() && at->contains(part)) {
      at = &(*at)[part];
      continue;
    }
    const std::optional<std::size_t> index = at->is_array() ? index_of(part) : std::nullopt;
    if (index) {
      if (*index >= at->size()) return "null";
      at = &(*at)[*index];
      continue;
    }
    const bool is_function = std::ranges::find(functions, part) != functions.end();
    if (!last || !is_function || !(at->is_array() || (at->is_object() && part == "count"))) return "null";
    return made_of(*at, part);
  }
  if (!at->is_structured()) return text_of(*at);
  throw bad_usage(fault_of_structure(path, at->is_array() || at->empty() ? "0" : at->begin().key()));
}

Json parsed(const std::string& json) {
  Json document = Json::parse(json, nullptr, false);
  if (document.is_discarded()) throw failure("a result is not JSON");
  return document;
}

/// What depends on the machine.
constexpr std::array<std::string_view, 3> in_the_provenance{"backend", "backend_why", "timing_ms"};

}  // namespace

std::string path_fault(const std::string& path) {
  if (path.empty() || path.size() > 200 || printable(path) != path)
    return "results must be paths of at most 200 characters, such as \"contacts.count\"";
  for (const std::string& part : parts_of(path)) {
    if (part.empty()) return fmt::format("results: {} has an empty part", path);
    if (std::ranges::find(in_the_provenance, part) != in_the_provenance.end())
      return fmt::format("results: {} is a time or a backend, which depends on the machine; see the provenance", path);
  }
  return {};
}

std::string structure_fault(const std::string& path, const std::vector<Structure>& structures) {
  const auto known = std::ranges::find(structures, without_indices(path), &Structure::path);
  return known == structures.end() ? std::string() : fault_of_structure(path, known->entry);
}

std::vector<std::string> results_of(const std::string& json, const std::vector<std::string>& paths) {
  const Json document = parsed(json);
  std::vector<std::string> results;
  results.reserve(paths.size());
  for (const std::string& path : paths)
    results.push_back(find(document, path));
  return results;
}

std::string name_fault(const std::string& json, const std::string& path) {
  const Json document = parsed(json);
  const Json* at = &document;
  const std::vector<std::string> parts = parts_of(path);
  std::string before;
  for (std::size_t i = 0; i < parts.size() && !at->is_null(); ++i) {
    const std::string& part = parts[i];
    const bool last = i + 1 == parts.size();
    std::vector<std::string> known;
    if (at->is_object()) {
      if (at->contains(part)) {
        at = &(*at)[part];
        before += part + '.';
        continue;
      }
      for (const auto& item : at->items())
        known.push_back(item.key());
      if (last) known.emplace_back("count");
    } else if (at->is_array()) {
      if (const std::optional<std::size_t> index = index_of(part)) {
        if (*index >= at->size()) return {};
        at = &(*at)[*index];
        before += part + '.';
        continue;
      }
      if (last) known.assign(functions.begin(), functions.end());
    }
    if (std::ranges::find(known, part) != known.end()) return {};
    const std::string nearest = nearest_word(part, known);
    return fmt::format("results: {} has no {}; {}", before.empty() ? "a case" : before.substr(0, before.size() - 1),
                       shortened(part, 40),
                       !nearest.empty() ? fmt::format("did you mean {}{}?", before, nearest)
                       : known.empty()
                           ? "leave it out"
                           : fmt::format("it has {}", shortened(fmt::to_string(fmt::join(known, ", ")), 200)));
  }
  return {};
}

std::string without_times(const std::string& json) {
  Json document = parsed(json);
  if (document.is_object()) {
    for (const std::string_view part : in_the_provenance)
      document.erase(std::string(part));
  }
  return document.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace palpa::sweep
