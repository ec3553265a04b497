// `palpa touch` within this process; its results are read like the program's.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/touch_json.hpp"

namespace palpa::test {

/// Like run_touch (touch_json.hpp), but starts no program.
inline TouchReport run_touch_here(const std::vector<std::string>& arguments, double delta = 1.5e-3,
                                  std::size_t foci = 10) {
  const Result result = palpa_here(with(with({"touch"}, arguments), {"--json", "-"}));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  return result.exit_code == 0 ? read_touch(result.out, delta, foci) : TouchReport();
}

}  // namespace palpa::test
