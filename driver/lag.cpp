#include "driver/lag.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace palpa::driver {

std::optional<double> take_lag(std::string& argument) {
  constexpr std::string_view key = ",lag=";
  const std::size_t at = argument.rfind(key);
  if (at == std::string::npos) return std::nullopt;
  const std::string text = argument.substr(at + key.size());
  const std::optional<double> periods = parse_number(text);
  if (!periods || !(*periods >= 0 && *periods < 1)) {
    throw bad_usage(fmt::format("lag={}: how late the further boards run, in periods, is a number from 0 to below 1",
                                printable(text, 40)));
  }
  argument.resize(at);
  return periods;
}

}  // namespace palpa::driver
