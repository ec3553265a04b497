// The location of palpa's own models and rigs, installed or in a source tree.
#pragma once

#include <string>

namespace palpa::setup {

/// The path of "rigs/paper.toml" and the like: in $PALPA_ASSETS if that is set, otherwise in share/palpa/assets beside
/// the program's bin folder, otherwise in the assets folder of the source tree in which the program was built. Throws
/// bad_input naming the asset and these places, and for a name that leads out of the folder.
std::string find_asset(const std::string& name);

/// For programs that are not in palpa's bin folder: find_asset() also looks into this folder, after $PALPA_ASSETS and
/// before the places beside the program.
void set_asset_folder(const std::string& folder);

}  // namespace palpa::setup
