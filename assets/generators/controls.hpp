// A mid-air button and a knob with their haptics: the scene of examples/button_and_knob.
#pragma once

#include <vector>

#include "geometry/gltf/gltf.hpp"

namespace palpa::assets {

/// "button": a disc of 30 mm around the y axis with a press depth of 3 mm. "knob": a disc of 60 mm around x = 80 mm,
/// softer and with eight foci. Both have their tops at y = 0.
std::vector<geometry::SceneMesh> make_button_and_knob();

}  // namespace palpa::assets
