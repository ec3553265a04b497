#include "setup/options/spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "line/together.hpp"
#include "line/values.hpp"
#include "sensing/rig.hpp"

namespace palpa::setup {
namespace {

constexpr const char* example = "amplitude=10%,phase=0.2,position=0.5mm,temperature=2";
constexpr double most_position_m = 0.01;

/// One key of --spread, with the largest value that is not a mistake.
struct Key {
  std::string_view name;
  double array::Spread::*value;
  double most;
  const char* range;  ///< for messages
};
constexpr Key keys[] = {
    {"amplitude", &array::Spread::amplitude, 1, "a part such as 0.1 or 10%, from 0 to 100%"},
    {"phase", &array::Spread::phase_rad, std::numbers::pi, "an angle in radians such as 0.2, from 0 to 3.14"},
    {"position", &array::Spread::position_m, most_position_m,
     "a length such as 0.5mm, from 0 to 10mm, or a rig.toml that palpa calibrate --out wrote"},
    {"temperature", &array::Spread::temperature, 20, "kelvins such as 2, from 0 to 20"},
};

/// The value of a key. nullopt if it is no number of its kind.
std::optional<double> value_of(const Key& key, std::string_view text) {
  if (key.value == &array::Spread::position_m) return parse_quantity(text, Quantity::length);
  const bool percent = key.value == &array::Spread::amplitude && text.ends_with('%');
  if (percent) text.remove_suffix(1);
  const std::optional<double> number = parse_number(text);
  return number && percent ? *number / 100 : number;
}

/// Whether the value of a position names a rig. A length never ends like a TOML.
bool is_rig(std::string_view position) {
  return position.ends_with(".toml");
}

/// The root mean square of the residuals of a rig's cameras.
double residual_of(const std::string& file) {
  double squares = 0, count = 0;
  for (const sensing::Camera& camera : sensing::load_rig(file).cameras) {
    if (!camera.residual_m) continue;
    squares += *camera.residual_m * *camera.residual_m;
    count += 1;
  }
  if (count == 0) {
    throw bad_input(file,
                    "no [[camera]] has a residual_m; --spread position= takes a rig that palpa calibrate --out wrote, "
                    "or a length such as 0.5mm");
  }
  const double residual = std::sqrt(squares / count);
  if (residual > most_position_m)
    throw bad_input(file, fmt::format("residual_m is {:.3g} m; --spread position= takes at most 10mm", residual));
  return residual;
}

/// Calls `take` with each key of the text and its value.
void read_items(std::string_view text, const std::function<void(const Key&, std::string_view)>& take) {
  std::vector<std::string_view> given;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::string_view item = rest.substr(0, comma);
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::string_view name = item.substr(0, equals);
    const auto key = std::ranges::find(keys, name, &Key::name);
    if (key == std::end(keys) || equals == item.size()) {
      throw bad_usage(
          fmt::format("--spread: '{}' is not one of amplitude=, phase=, position= and temperature=; such as {}",
                      printable(item, 60), example));
    }
    if (std::ranges::find(given, name) != given.end())
      throw bad_usage(fmt::format("--spread: {} is given twice", key->name));
    given.push_back(name);
    take(*key, item.substr(equals + 1));
    if (comma == std::string_view::npos) return;
    rest.remove_prefix(comma + 1);
  }
}

/// The spread of a text. A position that a rig gives is `of_rig` of its file.
array::Spread read_spread(std::string_view text, const std::function<double(const std::string&)>& of_rig) {
  array::Spread spread;
  read_items(text, [&](const Key& key, std::string_view text_of_value) {
    const bool rig = key.value == &array::Spread::position_m && is_rig(text_of_value);
    const std::optional<double> value = rig ? of_rig(std::string(text_of_value)) : value_of(key, text_of_value);
    if (!value || !(*value >= 0) || *value > key.most) {
      throw bad_usage(fmt::format("--spread: '{}={}' is not {}", key.name, printable(text_of_value, 60), key.range));
    }
    spread.*key.value = *value;
  });
  return spread;
}

/// The spread as far as the text alone gives it.
array::Spread read_text(std::string_view text) {
  return read_spread(text, [](const std::string&) { return 0.0; });
}

}  // namespace

void add_spread_options(CLI::App& app, SpreadOptions& options) {
  const line::Group group(app, "How sure the numbers are");
  group.text(
      "--spread", options.text, "KEY=VALUE,...",
      fmt::format("computes everything again for random arrays and reports ranges; standard deviations: {}", example),
      check_spread);
  group.integer("--draws", options.draws, least_draws, most_draws,
                fmt::format("with --spread: number of random arrays [{}]", default_draws));
  line::need(app, {"--draws"}, "--spread");
}

array::Spread parse_spread(const std::string& text) {
  return read_spread(text, residual_of);
}

void check_spread(const std::string& text) {
  read_text(text);
}

void check(const SpreadOptions& options, const MediumOptions& medium) {
  if (options.text.empty()) return;
  if (read_text(options.text).temperature > 0 && medium.sound_speed) {
    throw bad_usage(
        "--sound-speed replaces the temperature, and --spread varies it: give --temperature instead of --sound-speed");
  }
}

Percentiles percentiles(std::vector<double> values) {
  std::ranges::sort(values);
  const auto at = [&](double part) {
    const double place = part * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (place - static_cast<double>(below));
  };
  return {at(0.05), at(0.5), at(0.95)};
}

Draws draws_of(const SpreadOptions& options, std::uint64_t seed) {
  return {.count = options.draws.value_or(default_draws), .seed = seed};
}

MediumOptions warmer(MediumOptions medium, double temperature) {
  if (temperature == 0) return medium;
  medium.celsius = std::clamp(medium.celsius.value_or(20.0) + temperature, array::least_celsius, array::most_celsius);
  return medium;
}

std::string range_text(const Percentiles& range, int digits) {
  return fmt::format("{:.{}f} to {:.{}f}", range.p05, digits, range.p95, digits);
}

std::string spread_line(const Draws& draws) {
  return fmt::format("as built: the range of 90 % of {} random arrays (seed {})\n", draws.count, draws.seed);
}

}  // namespace palpa::setup
