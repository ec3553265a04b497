// The [[camera]] tables of a rig TOML, also used by a recording's TOML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/reference.hpp"
#include "base/toml.hpp"
#include "sensing/camera.hpp"

namespace palpa::sensing {

/// Every [[camera]] of the top-level table, at most 64, with their masks. Mask paths are relative to `folder`; if
/// `references` is given, they must lie inside its folder.
std::vector<Camera> read_cameras(TomlTable& root, const std::filesystem::path& folder,
                                 ReferenceFolder* references = nullptr);

/// One [[camera]] in the form that read_cameras reads.
std::string to_toml(const Camera& camera);

}  // namespace palpa::sensing
