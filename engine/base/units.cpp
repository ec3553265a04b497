#include "base/units.hpp"

#include <charconv>
#include <cmath>
#include <span>
#include <string>

namespace palpa {
namespace {

struct Unit {
  std::string_view name;
  int power_of_ten;
};

constexpr Unit length_units[]{{"m", 0}, {"cm", -2}, {"mm", -3}, {"um", -6}};
constexpr Unit time_units[]{{"s", 0}, {"ms", -3}, {"us", -6}};
constexpr Unit frequency_units[]{{"Hz", 0}, {"kHz", 3}, {"MHz", 6}};
constexpr Unit speed_units[]{{"m/s", 0}};
constexpr Unit pressure_units[]{{"Pa", 0}, {"kPa", 3}};

std::span<const Unit> units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return length_units;
    case Quantity::time:
      return time_units;
    case Quantity::frequency:
      return frequency_units;
    case Quantity::speed:
      return speed_units;
    case Quantity::pressure:
      return pressure_units;
  }
  return {};
}

/// The number times 10^power, rounded once: the power is added to the text's exponent, so that "998.8mm" is the double
/// 0.9988.
std::optional<double> parse_scaled(std::string_view number, int power) {
  const std::size_t e = number.find_first_of("eE");
  int exponent = 0;
  if (e != std::string_view::npos) {
    std::string_view digits = number.substr(e + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec != std::errc{}) return std::nullopt;
  }
  // Beyond this, a double is zero or infinite anyway, and the sum below cannot overflow.
  if (exponent < -100000 || exponent > 100000) return std::nullopt;
  return parse_number(std::string(number.substr(0, e)) + "e" + std::to_string(exponent + power));
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc{} || rest != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<double> parse_quantity(std::string_view text, Quantity quantity) {
  text = without_plus(text);
  double value = 0;
  const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || !std::isfinite(value)) return std::nullopt;
  const std::string_view number = text.substr(0, static_cast<std::size_t>(rest - text.data()));
  const std::string_view suffix = text.substr(number.size());
  if (suffix.empty()) return value;
  for (const Unit& unit : units_of(quantity)) {
    if (unit.name == suffix) return parse_scaled(number, unit.power_of_ten);
  }
  return std::nullopt;
}

std::string_view quantity_hint(Quantity quantity) {
  switch (quantity) {
    case Quantity::length:
      return "a length such as 1.5mm or 0.0015";
    case Quantity::time:
      return "a time such as 1.5ms or 0.0015";
    case Quantity::frequency:
      return "a frequency such as 40kHz or 40000";
    case Quantity::speed:
      return "a speed such as 343 or 343m/s";
    case Quantity::pressure:
      return "a pressure such as 8kPa or 8000";
  }
  return "a number";
}

}  // namespace palpa
