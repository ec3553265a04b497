// What keys and mouse do, and when: the sheet lists what has an effect now. A key that has no effect says why.
#pragma once

#include <string>
#include <vector>

#include "viewer/desk/desk.hpp"
#include "viewer/hands/controls.hpp"

namespace palpa::viewer {

/// Why the key has no effect now; empty if it has one, or is no key of the viewer.
std::string idle_reason(const Desk& desk, Key key);

/// A line of the sheet.
struct KeyLine {
  std::string keys, meaning;
};
/// The lines that apply now.
std::vector<KeyLine> key_lines(const Desk& desk);

}  // namespace palpa::viewer
