// Quantities in the form that users type: "1.5mm", "11ms", "40kHz". Everything inside palpa is SI; a bare number is SI.
#pragma once

#include <charconv>
#include <concepts>
#include <optional>
#include <string_view>
#include <system_error>

namespace palpa {

enum class Quantity { length, time, frequency, speed, pressure };

/// The text without a plus sign before a number.
constexpr std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+';
  return text.substr(plus ? 1 : 0);
}

/// The finite number that the whole `text` represents.
std::optional<double> parse_number(std::string_view text);

/// The whole number that the whole `text` represents, if T can hold it.
template <std::integral T>
std::optional<T> parse_whole(std::string_view text) {
  text = without_plus(text);
  T value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, fault] = std::from_chars(text.data(), end, value);
  return fault == std::errc{} && rest == end ? std::optional(value) : std::nullopt;
}

/// The value in metres, seconds, hertz, metres per second or pascals. Units: m cm mm um; s ms us; Hz kHz MHz; m/s; Pa
/// kPa.
/// nullopt unless the text is a finite number, alone or followed by a unit of that quantity.
std::optional<double> parse_quantity(std::string_view text, Quantity quantity);

/// The description of a quantity in messages, e.g. "a length such as 1.5mm or 0.0015".
std::string_view quantity_hint(Quantity quantity);

}  // namespace palpa
