#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"
#include "shaders/viewer/view_line.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewStroke items[]; };

void main() {
  const ViewStroke stroke = items[gl_VertexIndex / 6];
  const uint corner = uint(gl_VertexIndex) % 6u;
  half_width = stroke.from.w * push.style.y;
  line_colour = stroke.colour;
  if (push.style.x > 0.5) {
    line_corner(corner, stroke.from.xy, stroke.to.xy, 1.0, 1.0);
  } else {
    world_line_corner(corner, stroke.from.xyz, stroke.to.xyz);
  }
}
