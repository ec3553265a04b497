// What a command writes with --json, to compare with what the function under it gives.
#pragma once

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "cli/process.hpp"

namespace palpa::test {

/// The same text without the numbers of its times, which no two runs share.
inline std::string untimed(const std::string& json) {
  static const std::regex times(R"re(("timing_ms": \{)[^}]*\}|("seconds": )[0-9.e+-]+)re");
  return std::regex_replace(json, times, "$1$2");
}

/// What the command writes with --json -, without times, after checking that it succeeds.
inline std::string command_json(const std::vector<std::string>& arguments) {
  const Result result = palpa(with(arguments, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out, "");
  return untimed(result.out);
}

}  // namespace palpa::test
