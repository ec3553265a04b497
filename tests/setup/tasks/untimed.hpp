// A result as JSON, to compare it with another.
#pragma once

#include <regex>
#include <string>

namespace palpa::test {

/// The same text without its times, which differ from run to run.
inline std::string untimed(const std::string& json) {
  static const std::regex times(R"re(("timing_ms": \{)[^}]*\}|("seconds": )[0-9.e+-]+)re");
  return std::regex_replace(json, times, "$1$2");
}

}  // namespace palpa::test
