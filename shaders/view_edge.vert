#version 460
#extension GL_GOOGLE_include_directive : require
#include "view_scene.h"
#include "view_line.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewEdge items[]; };

void main() {
  const ViewEdge edge = items[gl_VertexIndex / 6];
  half_width = push.style.x;
  line_colour = push.colour;
  const vec3 viewer = towards_viewer(0.5 * (edge.from.xyz + edge.to.xyz));
  const bool outline = (dot(edge.left.xyz, viewer) > 0.0) != (dot(edge.right.xyz, viewer) > 0.0);
  if (edge.from.w > 0.5 || outline) {
    world_line_corner(uint(gl_VertexIndex) % 6u, edge.from.xyz, edge.to.xyz);
  } else {
    ends = vec4(0.0);
    gl_Position = nowhere;
  }
}
