#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_scene.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewVertex items[]; };
layout(location = 0) out vec3 world;
layout(location = 1) out vec3 normal;

void main() {
  world = items[gl_VertexIndex].position.xyz;
  normal = items[gl_VertexIndex].normal.xyz;
  gl_Position = to_clip(world);
}
