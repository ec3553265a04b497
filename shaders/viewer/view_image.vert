#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewVertex items[]; };
layout(location = 0) out vec2 place;  // within the image: 0, 0 is its top left, 1, 1 its bottom right

void main() {
  const ViewVertex corner = items[gl_VertexIndex];
  place = vec2(corner.position.w, corner.normal.w);
  gl_Position = to_clip(corner.position.xyz);
}
