// Tables of lines that palpa refuses or warns of.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/here.hpp"

namespace palpa::test {

/// Words that follow a line, and what palpa says about them.
struct Told {
  std::vector<std::string> more;
  std::string told;  ///< a part of the error or the warning
  int code = 2;
};

/// gtest: within this process, the line fails with each of these words after it (see expect_failure).
inline void expect_refused(const std::vector<std::string>& line, const std::vector<Told>& all) {
  for (const Told& one : all) {
    SCOPED_TRACE(testing::PrintToString(one.more));
    expect_failure(palpa_here(with(line, one.more)), one.code, one.told);
  }
}

/// gtest: within this process, the line succeeds with each of these words after it, with that one warning, or with none
/// if `told` is empty.
inline void expect_warned(const std::vector<std::string>& line, const std::vector<Told>& all) {
  for (const Told& one : all) {
    SCOPED_TRACE(testing::PrintToString(one.more));
    const Result result = palpa_here(with(line, one.more));
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err_lines().size(), one.told.empty() ? 0u : 1u) << result.err;
    if (one.told.empty()) continue;
    EXPECT_TRUE(result.err.starts_with("palpa: warning: ")) << result.err;
    EXPECT_NE(result.err.find(one.told), std::string::npos) << result.err << "\ndoes not contain: " << one.told;
  }
}

}  // namespace palpa::test
