// What keys ask for, besides those that move the view or things in it.
#pragma once

#include "viewer/hands/controls.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// Whether the key repeats while it is held down. Any other key would switch something on and off again and again.
bool goes_on(const WindowEvent& event);
/// Changes `data` as the key says. Returns false for any other key.
bool ask_by_key(const WindowEvent& event, PanelData& data);

}  // namespace palpa::viewer
