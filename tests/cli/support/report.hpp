// What a command reports as JSON.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/support/here.hpp"

namespace palpa::test {

/// What the line gives with --json, or nothing if it fails.
inline nlohmann::json report_of(const std::vector<std::string>& line) {
  const Result result = succeeded(palpa_here(with(line, {"--json", "-"})));
  return result.exit_code == 0 ? nlohmann::json::parse(result.out) : nlohmann::json();
}

}  // namespace palpa::test
