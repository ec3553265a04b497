// Where palpa's own models and rigs lie, installed or in a source tree.
#pragma once

#include <string>

namespace palpa::setup {

/// The path of "rigs/paper.toml" and the like: below $PALPA_ASSETS where that is set, else in share/palpa/assets beside
/// the program's bin folder, else in the assets folder of the source tree that the program was built in. Throws
/// bad_input naming the asset and these places.
std::string find_asset(const std::string& name);

}  // namespace palpa::setup
