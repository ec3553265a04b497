// palpa's own objects, rigs and layouts, for the panels' lists.
#pragma once

#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// Files that are not installed are left out.
void list_own_files(PanelData& data);

/// The scenes of the file's folder, by name, without fingers and hands unless the file is one of them.
std::vector<std::string> scenes_beside(const std::string& file);

}  // namespace palpa::viewer
