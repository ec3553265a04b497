// palpa's own objects, rigs and layouts, for the panels' lists.
#pragma once

#include "viewer/desk/desk.hpp"

namespace palpa::viewer {

/// Files that are not installed are left out.
void list_own_files(Desk& desk);

/// The scenes of the file's folder, by name, without fingers and hands unless the file is one of them.
std::vector<std::string> scenes_beside(const std::string& file);

}  // namespace palpa::viewer
