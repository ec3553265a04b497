// Where palpa's own models and rigs are, for programs that are not in palpa's bin folder.
#pragma once

#include <string>

namespace palpa::setup {

/// find_asset (assets.hpp) also looks into this folder, after $PALPA_ASSETS and before the places beside the program.
void set_asset_folder(const std::string& folder);

}  // namespace palpa::setup
