// `palpa touch` within this process: the finger model in the paper's cube.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

inline std::string asset_file(const std::string& name) {
  return source_file("assets/" + name).string();
}

/// The command's line.
inline std::vector<std::string> cube_touch(const std::vector<std::string>& more = {},
                                           const std::string& backend = "cpu") {
  return with({"touch", "--scene", asset_file("cube.glb"), "--points", asset_file("finger.ply"), "--penetration", "3mm",
               "--backend", backend},
              more);
}

}  // namespace palpa::test
