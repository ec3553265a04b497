// A run to an emulated board, and what it reports of its drives.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

inline std::vector<std::string> run_to_board(const std::string& link, const std::string& layout) {
  return with({"run", "--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--frames", "30",
               "--hold", "500ms", "--layout", layout, "--link", link},
              small_frames());
}

/// Checks that the counts of all hand-overs are in order and that no drive is missing. The numbers depend on the
/// machine.
inline void expect_counts(const std::string& results) {
  const nlohmann::json hand_over = nlohmann::json::parse(results)["hand_over"];
  ASSERT_TRUE(hand_over.contains("drives")) << results;
  for (const auto& [what, counts] : hand_over.items()) {
    SCOPED_TRACE(what);
    EXPECT_GE(counts["submitted"], counts["completed"]) << hand_over;
    EXPECT_GE(counts["guard"], counts["submitted"]) << hand_over;
    EXPECT_GE(counts["loop"], counts["guard"]) << hand_over;
  }
  const nlohmann::json drives = hand_over["drives"];
  EXPECT_EQ(drives["loop"].get<int>(),
            drives["completed"].get<int>() + drives["starting"].get<int>() + drives["lost"].get<int>());
}

}  // namespace palpa::test
