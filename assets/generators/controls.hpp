// A mid-air button and a knob, with what they ask for: the scene of examples/button_and_knob.
#pragma once

#include <vector>

#include "geometry/gltf/gltf.hpp"

namespace palpa::assets {

/// "button": a disc of 30 mm around the y axis that is pressed at 3 mm. "knob": one of 60 mm around x = 80 mm, softer
/// and with eight foci. Both have their tops at y = 0.
std::vector<geometry::SceneMesh> make_button_and_knob();

}  // namespace palpa::assets
