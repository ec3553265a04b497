// The [[camera]] tables of a rig TOML, also used by a recording's TOML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/files/reference.hpp"
#include "base/files/toml.hpp"
#include "sensing/camera.hpp"

namespace palpa::sensing {

/// Every [[camera]] of the top-level table, at most 64, with their masks and backgrounds, whose paths are relative to
/// `folder`; if
/// `references` is given, they must lie inside its folder.
std::vector<Camera> read_cameras(TomlTable& root, const std::filesystem::path& folder,
                                 ReferenceFolder* references = nullptr);

/// The image of the camera's background, which must not be null, in the form that read_cameras reads: it also says of
/// which camera it is.
void write_background(const std::filesystem::path& file, const Camera& camera);

/// One [[camera]] in the form that read_cameras reads.
std::string to_toml(const Camera& camera);

}  // namespace palpa::sensing
