// Four floats as shaders take them, such as a row of a projection, a point or a colour.
#pragma once

#include <glm/vec3.hpp>

#include "base/math.hpp"
#include "drawing/colour.hpp"
#include "shaders/viewer/view_scene.h"

namespace palpa::viewer {

inline shader::vec4 vec4_of(const glm::vec3& v, float w) {
  return {v.x, v.y, v.z, w};
}
inline shader::vec4 vec4_of(const Vec3& v, double w) {
  return vec4_of(glm::vec3(v), static_cast<float>(w));
}
inline shader::vec4 vec4_of(const drawing::Colour& c, float w) {
  return {c.r, c.g, c.b, w};
}
inline shader::vec4 vec4_of(const drawing::Colour& c) {
  return vec4_of(c, c.a);
}

}  // namespace palpa::viewer
