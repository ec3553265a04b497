// --spread: how sure a result is, given the tolerances of the array and of the air. The result is computed again for
// random arrays (array/layouts/as_built.hpp), and each of its numbers gets the range in which nine of ten of them lie.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/as_built.hpp"
#include "array/medium.hpp"
#include "base/files/json_rows.hpp"
#include "setup/options/options.hpp"

namespace CLI {
class App;
}

namespace palpa::setup {

/// Draws if none are requested, and limits of --draws.
inline constexpr std::uint32_t default_draws = 200, least_draws = 20, most_draws = 100'000;

struct SpreadOptions {
  std::string text;                    ///< for parse_spread; empty: none
  std::optional<std::uint32_t> draws;  ///< default default_draws
};
/// --spread and --draws.
void add_spread_options(CLI::App& app, SpreadOptions& options);

/// The spread of a text such as "amplitude=10%,phase=0.2,position=0.5mm,temperature=2". A position may also be a rig
/// that `palpa calibrate --out` wrote, "position=RIG.toml": the root mean square of its cameras' residual_m. Throws
/// bad_usage for an unknown or repeated key and for a value out of range, bad_input for a rig without a usable
/// residual, and as sensing::load_rig does.
array::Spread parse_spread(const std::string& text);
/// The same checks, but of the text alone: a rig is not read.
void check_spread(const std::string& text);

/// Throws bad_usage for a spread of the temperature where the sound speed is given.
void check(const SpreadOptions& options, const MediumOptions& medium);

/// Percentiles of one number over all draws, interpolated linearly between neighbours.
struct Percentiles {
  double p05 = 0, p50 = 0, p95 = 0;
};
inline std::array<double, 3> numbers_of(const Percentiles& range) {
  return {range.p05, range.p50, range.p95};
}
/// The same of several: `ranges` must outlive the result.
inline auto lists_of(std::span<const Percentiles> ranges) {
  return std::views::transform(ranges, [](const Percentiles& range) { return numbers_of(range); });
}
/// `values` must not be empty. NaN must not occur.
Percentiles percentiles(std::vector<double> values);

/// How a spread was computed; its results follow in their own structures.
struct Draws {
  std::uint32_t count = 0;
  std::uint64_t seed = 0;
};
Draws draws_of(const SpreadOptions& options, std::uint64_t seed);
/// The first members of the object "spread" of a result that has `draws`; its percentiles follow.
template <typename T>
JsonRows<T> spread_rows() {
  return JsonRows<T>()
      .value("draws", [](const T& spread) { return spread.draws.count; })
      .value("seed", [](const T& spread) { return spread.draws.seed; });
}

/// The air of a draw: the medium's options at `temperature` kelvin above theirs, within the accepted range.
MediumOptions warmer(MediumOptions medium, double temperature);

/// "3.80 to 4.31", the range of nine of ten draws, with this many digits after the decimal point.
std::string range_text(const Percentiles& percentiles, int digits);

/// The line of a summary that says what "as built" means in it.
std::string spread_line(const Draws& draws);

}  // namespace palpa::setup
