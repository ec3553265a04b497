#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewVertex items[]; };
// Drawn for depth alone and then in colour, a surface must give the same depth both times.
invariant gl_Position;
layout(location = 0) out vec3 world;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec3 paint;

void main() {
  world = items[gl_VertexIndex].position.xyz;
  const vec4 around = items[gl_VertexIndex].normal;
  normal = around.xyz;
  const uint own = uint(items[gl_VertexIndex].position.w);
  paint = around.w > 0.5 && push.style.z < 0.5 ? vec3(own >> 16u, (own >> 8u) & 255u, own & 255u) / 255.0 : push.colour.rgb;
  gl_Position = to_clip(world);
}
