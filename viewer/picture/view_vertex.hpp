// Corners in the form that view_mesh.vert reads.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "drawing/colour.hpp"
#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

/// A corner that has the colour of the draw call.
inline shader::ViewVertex plain(const glm::vec3& position, const glm::vec3& normal) {
  return {{position.x, position.y, position.z, 0}, {normal.x, normal.y, normal.z, 0}};
}

/// A corner with its own colour, in 255ths and without alpha.
inline shader::ViewVertex coloured(const glm::vec3& position, const glm::vec3& normal, const drawing::Colour& colour) {
  const auto step = [](float v) { return std::round(std::clamp(v, 0.0f, 1.0f) * 255.0f); };
  const float own = (step(colour.r) * 256.0f + step(colour.g)) * 256.0f + step(colour.b);
  return {{position.x, position.y, position.z, own}, {normal.x, normal.y, normal.z, 1}};
}

}  // namespace palpa::viewer
