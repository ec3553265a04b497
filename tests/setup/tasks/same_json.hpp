// Compares a task's JSON with its command's.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"

namespace palpa::test {

/// A document without the contents of each "timing_ms", which may differ from run to run.
inline std::string without_times(std::string json) {
  const std::string key = "\"timing_ms\": {";
  for (std::size_t at = json.find(key); at != std::string::npos; at = json.find(key, at + key.size())) {
    const std::size_t begin = at + key.size();
    json.erase(begin, json.find('}', begin) - begin);
  }
  return json;
}

/// gtest: the command with --json - prints these bytes, except for times.
inline void expect_same_json(const std::string& json, const std::vector<std::string>& command) {
  const Result result = palpa(with(command, {"--json", "-"}));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(json.find("\"timing_ms\": {"), std::string::npos) << json;
  EXPECT_EQ(without_times(json), without_times(result.out));
}

}  // namespace palpa::test
