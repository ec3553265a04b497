// Messages for files that others will read: without the folders of files, which may have people's names.
#pragma once

#include <string>
#include <string_view>

namespace palpa {

/// A message with the names of files, but not of the folders that they are in: "/data/alice/rig.toml: is empty" becomes
/// "rig.toml: is empty". Devices keep their folder /dev.
std::string without_folders(std::string_view text);

}  // namespace palpa
