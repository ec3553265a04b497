// What keys and mouse do, and when: the sheet lists what has an effect now. A key that has no effect says why.
#pragma once

#include <string>
#include <vector>

#include "viewer/hands/controls.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// Why the key has no effect now; empty if it has one, or is no key of the viewer.
std::string idle_reason(const PanelData& data, Key key);

/// A line of the sheet.
struct KeyLine {
  std::string keys, meaning;
};
/// The lines that apply now.
std::vector<KeyLine> key_lines(const PanelData& data);

}  // namespace palpa::viewer
