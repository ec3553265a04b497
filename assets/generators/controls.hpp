// Objects with haptics: the scenes of examples/button_and_knob and of docs/design.md.
#pragma once

#include <vector>

#include "geometry/gltf/gltf.hpp"

namespace palpa::assets {

/// "button": a disc of 30 mm around the y axis that clicks at 3 mm. "knob": a disc of 60 mm around x = 80 mm, softer
/// and with eight foci. Both have their tops at y = 0.
std::vector<geometry::SceneMesh> make_button_and_knob();

/// Four objects with their tops at y = 0. "button", a disc of 30 mm around the y axis, clicks. Around it are "spring",
/// a disc that gets stiffer with the depth, and two plates with textures, "rough" and "smooth".
std::vector<geometry::SceneMesh> make_design();

}  // namespace palpa::assets
