#include "line/values.hpp"

#include <fmt/core.h>

#include <CLI/App.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.hpp"
#include "base/text.hpp"

namespace palpa::line {
namespace {

std::string shown(const std::string& text) {
  return printable(text, 60);
}

std::string range_words(const Range& range, const std::function<std::string(double)>& format) {
  const bool bounded = range.high < 1e300;
  if (!bounded) return fmt::format("{} {}", range.open ? "above" : "at least", format(range.low));
  if (range.open) return fmt::format("above {}, at most {}", format(range.low), format(range.high));
  return fmt::format("from {} to {}", format(range.low), format(range.high));
}

bool within(double value, const Range& range) {
  return (range.open ? value > range.low : value >= range.low) && value <= range.high;
}

[[noreturn]] void refuse_quantity(const std::string& name, const std::string& text, Quantity quantity,
                                  const Range& range) {
  throw bad_usage(fmt::format("{}: '{}' is out of range, give a value {}", name, shown(text),
                              range_words(range, [&](double v) { return format_quantity(v, quantity); })));
}

double take_quantity(const std::string& name, const std::string& text, Quantity quantity, const Range& range) {
  const std::optional<double> value = parse_quantity(text, quantity);
  if (!value) throw bad_usage(fmt::format("{}: '{}' is not {}", name, shown(text), quantity_hint(quantity)));
  if (!within(*value, range)) refuse_quantity(name, text, quantity, range);
  return *value;
}

double take_number(const std::string& name, const std::string& text, const Range& range) {
  const std::optional<double> value = parse_number(text);
  if (!value) throw bad_usage(fmt::format("{}: '{}' is not a number", name, shown(text)));
  if (!within(*value, range)) {
    throw bad_usage(fmt::format("{}: '{}' is out of range, give a number {}", name, shown(text),
                                range_words(range, [](double v) { return fmt::format("{}", v); })));
  }
  return *value;
}

std::uint64_t take_integer(const std::string& name, const std::string& text, std::uint64_t low, std::uint64_t high) {
  const std::optional<std::uint64_t> value = parse_whole<std::uint64_t>(text);
  if (!value || *value < low || *value > high)
    throw bad_usage(fmt::format("{}: '{}' is not a whole number from {} to {}", name, shown(text), low, high));
  return *value;
}

/// 400k, 1M, 12345.
std::string format_count(std::uint32_t value) {
  if (value != 0 && value % 1'000'000 == 0) return fmt::format("{}M", value / 1'000'000);
  if (value != 0 && value % 1'000 == 0) return fmt::format("{}k", value / 1'000);
  return fmt::format("{}", value);
}

const char* quantity_type(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return "LENGTH";
    case Quantity::time:
      return "TIME";
    case Quantity::frequency:
      return "FREQUENCY";
    case Quantity::speed:
      return "SPEED";
    case Quantity::pressure:
      return "PRESSURE";
  }
  return "NUMBER";
}

}  // namespace

std::string format_quantity(double value, Quantity quantity) {
  const double size = std::abs(value);
  struct Unit {
    const char* name;
    double per_si;
  };
  Unit unit{"", 1};
  switch (quantity) {
    case Quantity::length:
      unit = size != 0 && size < 1 ? Unit{"mm", 1e3} : Unit{"m", 1};
      break;
    case Quantity::time:
      unit = size != 0 && size < 1 ? Unit{"ms", 1e3} : Unit{"s", 1};
      break;
    case Quantity::frequency:
      unit = size >= 1e3 ? Unit{"kHz", 1e-3} : Unit{"Hz", 1};
      break;
    case Quantity::speed:
      unit = {"m/s", 1};
      break;
    case Quantity::pressure:
      unit = size >= 1e3 ? Unit{"kPa", 1e-3} : Unit{"Pa", 1};
      break;
  }
  std::string scaled = fmt::format("{}{}", value * unit.per_si, unit.name);
  if (parse_quantity(scaled, quantity) == value) return scaled;
  // If scaling rounds the value, the SI number itself is the shortest exact text.
  return fmt::format("{}", value);
}

std::array<double, 3> parse_point(const std::string& option, const std::string& text) {
  std::array<double, 3> point{};
  std::string_view rest = text;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = rest.find(',');
    const bool last = i == 2;
    const std::optional<double> value = (comma == std::string_view::npos) == last
                                            ? parse_quantity(rest.substr(0, comma), Quantity::length)
                                            : std::nullopt;
    if (!value) {
      throw bad_usage(
          fmt::format("{}: '{}' is not a point x,y,z such as 0,0,150mm or 0,0,0.15 (metres)", option, shown(text)));
    }
    point[i] = *value;
    if (!last) rest.remove_prefix(comma + 1);
  }
  return point;
}

namespace {

double largest_of(const std::array<double, 3>& numbers) {
  return std::max({std::abs(numbers[0]), std::abs(numbers[1]), std::abs(numbers[2])});
}

}  // namespace

std::array<double, 3> parse_direction(const std::string& option, const std::string& text) {
  std::array<double, 3> way = parse_point(option, text);
  const double largest = largest_of(way);
  if (!(largest > 0))
    throw bad_usage(fmt::format("{}: '{}' is not a direction; give one such as 0,0,1", option, shown(text)));
  if (largest > 1e-100 && largest < 1e100) return way;
  for (double& number : way)
    number /= largest;
  return way;
}

void Group::add(const std::string& name, const std::string& type, const std::string& initial, const std::string& help,
                const std::function<void(const std::string&)>& take) const {
  const std::string text = initial.empty() ? help : fmt::format("{} [{}]", help, initial);
  app_->add_option_function<std::string>(name, take, text)->type_name(type)->group(heading_);
}

void Group::quantity(const std::string& name, const Target<double>& target, Quantity quantity, const Range& range,
                     const std::string& help, bool* given) const {
  add(name, quantity_type(quantity), target.initial ? format_quantity(*target.initial, quantity) : "", help,
      [=](const auto& text) {
        target.set(take_quantity(name, text, quantity, range));
        if (given) *given = true;
      });
}

void Group::quantity_or_auto(const std::string& name, double& target, bool& automatic, Quantity quantity,
                             const Range& range, const std::string& help) const {
  add(name, std::string(quantity_type(quantity)) + "|auto", format_quantity(target, quantity), help,
      [name, usual = target, &target, &automatic, quantity, range](const auto& text) {
        automatic = text == "auto";
        target = automatic ? usual : take_quantity(name, text, quantity, range);
      });
}

void Group::number(const std::string& name, const Target<double>& target, const Range& range, const std::string& type,
                   const std::string& help, bool* given) const {
  add(name, type, target.initial ? fmt::format("{}", *target.initial) : "", help, [=](const auto& text) {
    target.set(take_number(name, text, range));
    if (given) *given = true;
  });
}

void Group::integer(const std::string& name, const Target<std::uint64_t>& target, std::uint64_t low, std::uint64_t high,
                    const std::string& help) const {
  add(name, "N", target.initial ? fmt::format("{}", *target.initial) : "", help,
      [=](const auto& text) { target.set(take_integer(name, text, low, high)); });
}

void Group::count(const std::string& name, std::uint32_t& target, std::uint32_t low, std::uint32_t high,
                  const std::string& help) const {
  const auto take = [name, &target, low, high](const std::string& text) {
    double value = 0;
    const std::string_view number = without_plus(text);
    const char* end = number.data() + number.size();
    const auto [rest, fault] = std::from_chars(number.data(), end, value);
    const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
    value *= unit == "k" ? 1e3 : unit == "M" ? 1e6 : 1;
    const bool known = unit.empty() || unit == "k" || unit == "M";
    if (fault != std::errc{} || !known || !(value >= low && value <= high) || value != std::floor(value)) {
      throw bad_usage(fmt::format("{}: '{}' is not a whole number from {} to {}, such as {}", name, shown(text), low,
                                  high, format_count(target)));
    }
    target = static_cast<std::uint32_t>(value);
  };
  add(name, "N", format_count(target), help, take);
}

void Group::text(const std::string& name, std::string& target, const std::string& type, const std::string& help,
                 const Check& check) const {
  add(name, type, target, help, [name, type, &target, check](const std::string& text) {
    if (text.empty()) throw bad_usage(fmt::format("{}: the value is empty, give {}", name, type));
    if (check) check(text);
    target = text;
  });
}

void Group::point(const std::string& name, std::string& target, const std::string& help) const {
  text(name, target, "X,Y,Z", help, [name](const std::string& text) {
    if (largest_of(parse_point(name, text)) <= farthest_point_m) return;
    throw bad_usage(fmt::format("{}: '{}' is farther than {} km away, give a point nearer to the origin", name,
                                shown(text), farthest_point_m / 1e3));
  });
}

void Group::texts(const std::string& name, std::vector<std::string>& target, const std::string& type,
                  const std::string& help, const Check& check) const {
  each(name, type, help, [&target, check](const std::vector<std::string>& all) {
    if (check) std::ranges::for_each(all, check);
    target = all;
  });
}

void Group::each(const std::string& name, const std::string& type, const std::string& help,
                 std::function<void(const std::vector<std::string>&)> take) const {
  app_->add_option_function<std::vector<std::string>>(
          name,
          [name, type, take](const std::vector<std::string>& all) {
            if (std::ranges::any_of(all, &std::string::empty))
              throw bad_usage(fmt::format("{}: the value is empty, give {}", name, type));
            take(all);
          },
          help)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false)  // otherwise, "[a,b]" would be split
      ->type_name(type)
      ->group(heading_);
}

void Group::words(const std::string& name, std::vector<std::string>& target, const std::string& type,
                  const std::string& help) const {
  app_->add_option_function<std::vector<std::string>>(
          name,
          [type, &target](const std::vector<std::string>& all) {
            for (const std::string& text : all) {
              if (text.empty()) throw bad_usage(fmt::format("a word of the line is empty, give {}", type));
            }
            target = all;
          },
          help)
      ->type_name(type)
      ->group(heading_);
}

void Group::pair(const std::string& name, std::array<std::string, 2>& target, const std::string& type,
                 const std::string& help, const Check& check) const {
  app_->add_option_function<std::vector<std::string>>(
          name,
          [name, type, &target, check](const std::vector<std::string>& both) {
            if (both.size() != 2 || both[0].empty() || both[1].empty())
              throw bad_usage(fmt::format("{}: give two values, {} {}", name, type, type));
            if (check) std::ranges::for_each(both, check);
            target = {both[0], both[1]};
          },
          help)
      ->expected(2)
      ->allow_extra_args(false)
      ->type_name(type)
      ->group(heading_);
}

void Group::flag(const std::string& name, bool& target, const std::string& help) const {
  app_->add_flag_callback(
          name, [&target] { target = true; }, help)
      ->disable_flag_override()
      ->group(heading_);
}

void Group::pick(const std::string& name, std::vector<std::string> words, std::size_t initial, const std::string& help,
                 std::function<void(std::size_t)> chosen) const {
  std::string list;
  for (const std::string& word : words)
    list += (list.empty() ? "" : "|") + word;
  std::string plain = help, shown_initial = initial < words.size() ? words[initial] : "";
  if (const std::size_t open = help.rfind(" ["); shown_initial.empty() && help.ends_with(']') && open != help.npos) {
    shown_initial = help.substr(open + 2, help.size() - open - 3);
    plain.resize(open);
  }
  add(name, "WORD", shown_initial, fmt::format("{}: {}", plain, list),
      [name, words = std::move(words), list, chosen = std::move(chosen)](const std::string& text) {
        for (std::size_t i = 0; i < words.size(); ++i) {
          if (words[i] == text) return chosen(i);
        }
        throw bad_usage(fmt::format("{}: '{}' is not one of {}", name, shown(text), list));
      });
}

void check_quantity(const std::string& option, double value, Quantity quantity, const Range& range) {
  if (!within(value, range)) refuse_quantity(option, format_quantity(value, quantity), quantity, range);
}

}  // namespace palpa::line
