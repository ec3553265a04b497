// The output of a command with --json, to compare it with the result of the function that the command calls.
#pragma once

#include <gtest/gtest.h>

#include <regex>
#include <string>
#include <vector>

#include "cli/support/process.hpp"

namespace palpa::test {

/// The same text without its times, which differ from run to run.
inline std::string untimed(const std::string& json) {
  static const std::regex times(R"re(("timing_ms": \{)[^}]*\}|("seconds": )[0-9.e+-]+)re");
  return std::regex_replace(json, times, "$1$2");
}

/// The output of the command with --json -, without times; checks that the command succeeds.
inline std::string command_json(const std::vector<std::string>& arguments) {
  const Result result = palpa(with(arguments, {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out, "");
  return untimed(result.out);
}

/// gtest: the command prints these bytes, except for times.
inline void expect_same_json(const std::string& json, const std::vector<std::string>& command) {
  EXPECT_EQ(untimed(json), command_json(command));
}

}  // namespace palpa::test
