// What keys ask for, besides those that move the view or things in it.
#pragma once

#include "viewer/hands/controls.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// Changes `data` as the key says. Returns false for any other key.
bool ask_by_key(const WindowEvent& event, PanelData& data);

}  // namespace palpa::viewer
