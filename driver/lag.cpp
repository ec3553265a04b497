#include "driver/lag.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace palpa::driver {

std::optional<double> take_lag(std::string& argument) {
  constexpr std::string_view key = ",lag=";
  const std::size_t at = argument.find(key);
  if (at == std::string::npos) return std::nullopt;
  const std::string text = argument.substr(at + key.size());
  if (text.find(key) != std::string::npos) throw bad_usage("lag= is given twice in a link: give it once, at its end");
  if (const std::size_t comma = text.find(','); comma != std::string::npos) {
    throw bad_usage(fmt::format("a link's lag= comes last, after its boards and other words: {}{}{}{}",
                                printable(argument.substr(0, at), 200), printable(text.substr(comma), 200), key,
                                printable(text.substr(0, comma), 40)));
  }
  const std::optional<double> periods = parse_number(text);
  if (!periods || !(*periods >= 0 && *periods < 1)) {
    throw bad_usage(fmt::format("lag={}: how late the further boards run, in periods, is a number from 0 to below 1",
                                printable(text, 40)));
  }
  argument.resize(at);
  return periods;
}

void refuse_lag_of_one(const std::optional<double>& lag, std::size_t boards) {
  if (!lag || boards > 1) return;
  throw bad_usage(fmt::format(
      "lag={} says how late further boards run after the first one, but the link has one board: leave it out", *lag));
}

}  // namespace palpa::driver
