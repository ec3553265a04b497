#include "base/units.hpp"

#include <charconv>
#include <cmath>
#include <span>

namespace palpa {
namespace {

struct Unit {
  std::string_view name;
  double si;
};

constexpr Unit length_units[]{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}};
constexpr Unit time_units[]{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}};
constexpr Unit frequency_units[]{{"Hz", 1.0}, {"kHz", 1e3}, {"MHz", 1e6}};
constexpr Unit speed_units[]{{"m/s", 1.0}};

std::span<const Unit> units_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::length: return length_units;
    case Quantity::time: return time_units;
    case Quantity::frequency: return frequency_units;
    case Quantity::speed: return speed_units;
  }
  return {};
}

}  // namespace

std::optional<double> parse_quantity(std::string_view text, Quantity quantity) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, value);
  if (fault != std::errc{} || !std::isfinite(value)) return std::nullopt;
  if (rest == end) return value;
  const std::string_view suffix(rest, static_cast<std::size_t>(end - rest));
  for (const Unit& unit : units_of(quantity)) {
    // Dividing by the whole number of units per SI unit rounds once: "1.5mm" is exactly the double 0.0015.
    if (unit.name == suffix) return unit.si < 1.0 ? value / std::round(1.0 / unit.si) : value * unit.si;
  }
  return std::nullopt;
}

std::string_view quantity_hint(Quantity quantity) {
  switch (quantity) {
    case Quantity::length: return "a length such as 1.5mm or 0.0015";
    case Quantity::time: return "a time such as 1.5ms or 0.0015";
    case Quantity::frequency: return "a frequency such as 40kHz or 40000";
    case Quantity::speed: return "a speed such as 343 or 343m/s";
  }
  return "a number";
}

}  // namespace palpa
