#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"
#include "shaders/viewer/view_line.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewEdge items[]; };

void main() {
  const ViewEdge edge = items[gl_VertexIndex / 6];
  half_width = push.style.x;
  line_colour = push.colour;
  world_line_corner(uint(gl_VertexIndex) % 6u, edge.from.xyz, edge.to.xyz);
}
