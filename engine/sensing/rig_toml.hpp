// The [[camera]] tables of a rig TOML, which a recording's TOML shares.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/reference.hpp"
#include "base/toml.hpp"
#include "sensing/camera.hpp"

namespace palpa::sensing {

/// Every [[camera]] of the top-level table, at most 64, with their masks, which are found from `folder`; where
/// `references` is given they lie within that.
std::vector<Camera> read_cameras(TomlTable& root, const std::filesystem::path& folder,
                                 ReferenceFolder* references = nullptr);

/// One [[camera]] as read_cameras reads it.
std::string to_toml(const Camera& camera);

}  // namespace palpa::sensing
