#include "sweep/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "base/nearest_word.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace palpa::sweep {
namespace {

using Kind = TomlValue::Kind;

/// A number and the unit behind it: "1.5mm" is 1.5 and "mm".
std::optional<std::pair<double, std::string>> split_unit(const TomlValue& value) {
  if (value.kind != Kind::text && value.kind != Kind::number) return std::nullopt;
  double number = 0;
  const char* const end = value.text.data() + value.text.size();
  const auto [rest, fault] = std::from_chars(value.text.data(), end, number);
  if (fault != std::errc{} || !std::isfinite(number)) return std::nullopt;
  return std::pair(number, std::string(rest, end));
}

/// Equal steps from one value to another. Steps are rounded to twelve digits, so that they read as people write them.
std::vector<TomlValue> steps_of(const TomlValue& table) {
  const TomlValue *from = nullptr, *to = nullptr, *count = nullptr;
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    const std::string& key = table.keys[i];
    const TomlValue& value = table.items[i];
    if (key == "from") {
      from = &value;
    } else if (key == "to") {
      to = &value;
    } else if (key == "count") {
      count = &value;
    } else {
      throw ValueFault{fmt::format("unknown key {}; known: from, to, count", printable(key, 40))};
    }
  }
  if (from == nullptr || to == nullptr || count == nullptr) throw ValueFault{"needs from, to and count"};
  const auto first = split_unit(*from), last = split_unit(*to);
  if (!first || !last || first->second != last->second)
    throw ValueFault{"from and to must be numbers with the same unit, such as \"1mm\" and \"3mm\""};
  const auto steps = split_unit(*count);
  if (!steps || count->kind != Kind::number || steps->first != std::floor(steps->first) || steps->first < 2 ||
      steps->first > static_cast<double>(most_cases))
    throw ValueFault{fmt::format("count must be a whole number from 2 to {}", most_cases)};
  std::vector<TomlValue> values;
  const auto n = static_cast<std::uint64_t>(steps->first);
  for (std::uint64_t i = 0; i < n; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(n - 1);
    const double exact = first->first * (1 - part) + last->first * part;
    const double rounded = i == 0 ? first->first : i == n - 1 ? last->first : std::stod(fmt::format("{:.12g}", exact));
    values.push_back({Kind::text, fmt::format("{}{}", rounded, first->second), {}});
  }
  return values;
}

}  // namespace

const setup::OptionInfo& option_of(const std::vector<setup::OptionInfo>& table, const std::string& key) {
  const std::string name = "--" + key;
  const auto found = std::ranges::find(table, name, &setup::OptionInfo::name);
  if (found != table.end()) return *found;
  std::vector<std::string> keys;
  keys.reserve(table.size());
  for (const setup::OptionInfo& option : table)
    keys.push_back(option.name.substr(2));
  const std::string nearest = nearest_word(key, keys);
  throw ValueFault{fmt::format("{} is not an option that a case can have{}", printable(key, 40),
                               nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest))};
}

Setting setting_of(const setup::OptionInfo& option, const TomlValue& value) {
  const std::string key = option.name.substr(2);
  if (option.flag) {
    if (value.kind != Kind::flag) throw ValueFault{fmt::format("{} must be true or false", key)};
    return {option.name, {}, value.text == "true"};
  }
  Setting setting{option.name, {}};
  const auto add = [&](const TomlValue& one) {
    if (one.kind != Kind::text && one.kind != Kind::number)
      throw ValueFault{fmt::format("{} must be a text or a number", key)};
    setting.values.push_back(one.text);
  };
  if (value.kind == Kind::list) {
    if (value.items.empty()) throw ValueFault{fmt::format("{} has an empty list", key)};
    std::ranges::for_each(value.items, add);
  } else {
    add(value);
  }
  return setting;
}

std::uint64_t count_of(const TomlValue& value) {
  if (value.kind == Kind::list) return std::max<std::uint64_t>(value.items.size(), 1);
  if (value.kind != Kind::table) return 1;
  const auto key = std::ranges::find(value.keys, std::string_view("count"));
  if (key == value.keys.end()) return 1;
  const auto steps = split_unit(value.items[static_cast<std::size_t>(key - value.keys.begin())]);
  return steps && steps->first >= 1 && steps->first <= 1e18 ? static_cast<std::uint64_t>(steps->first) : 1;
}

Axis axis_of(const std::vector<setup::OptionInfo>& table, const std::string& key, const TomlValue& value) {
  Axis axis{key, {}, {}};
  const std::vector<TomlValue> values = value.kind == Kind::table  ? steps_of(value)
                                        : value.kind == Kind::list ? value.items
                                                                   : std::vector<TomlValue>();
  if (values.empty()) throw ValueFault{fmt::format("{} must be a list of values, or have from, to and count", key)};
  const bool together = std::ranges::all_of(values, [](const TomlValue& one) { return one.kind == Kind::table; });
  std::unordered_set<std::string> known;
  for (const TomlValue& one : values) {
    std::vector<Setting> choice;
    if (together) {
      for (std::size_t i = 0; i < one.items.size(); ++i)
        choice.push_back(setting_of(option_of(table, one.keys[i]), one.items[i]));
      if (choice.empty()) throw ValueFault{fmt::format("{} has an empty table", key)};
    } else {
      choice.push_back(setting_of(option_of(table, key), one));
    }
    std::string text;
    for (const Setting& setting : choice)
      text += fmt::format("{}\n{}\n{}\n", setting.option, setting.values.size(), setting.shown());
    if (!known.insert(std::move(text)).second)
      throw ValueFault{fmt::format("{} has a value twice: {}", key, shortened(choice.front().shown(), 60))};
    for (const Setting& setting : choice) {
      if (std::ranges::find(axis.options, setting.option) == axis.options.end()) axis.options.push_back(setting.option);
    }
    axis.choices.push_back(std::move(choice));
  }
  return axis;
}

}  // namespace palpa::sweep
