#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

layout(std430, set = 0, binding = view_items) readonly buffer Items { ViewDisc items[]; };
layout(location = 0) out vec2 place;  // within the disc: 1 is the rim
layout(location = 1) flat out vec4 disc_colour;
layout(location = 2) flat out float radius;  // pixels
layout(location = 3) flat out float ball;

void main() {
  // One triangle around the disc costs half as much as a square of two triangles.
  const ViewDisc disc = items[gl_VertexIndex / 3 * int(push.style.w)];
  const uint corner = uint(gl_VertexIndex) % 3u;
  const float side = 1.7320508;
  const vec2 around = corner == 0u ? vec2(-side, -1.0) : corner == 1u ? vec2(side, -1.0) : vec2(0.0, 2.0);
  disc_colour = disc.colour;
  gl_Position = nowhere;
  place = vec2(0.0);
  radius = 1.0;
  ball = 0.0;
  const vec4 centre = to_clip(disc.centre.xyz);
  if (centre.w <= 0.0) return;
  radius = disc_radius(disc, centre.w);
  place = around * (radius + 1.0) / radius;  // one pixel more, for the soft edge
  if (dot(disc.axis.xyz, disc.axis.xyz) < 0.5) {
    ball = 1.0;
    gl_Position = centre;
    gl_Position.xy += place * radius * 2.0 / push.window.xy * centre.w;
  } else if (dot(disc.axis.xyz, towards_viewer(disc.centre.xyz)) > 0.0) {  // seen from behind, it would hide the inside
    const vec3 across = abs(disc.axis.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    const vec3 u = normalize(cross(across, disc.axis.xyz));
    const vec3 v = cross(disc.axis.xyz, u);
    gl_Position = to_clip(disc.centre.xyz + (u * place.x + v * place.y) * disc.centre.w);
  }
  gl_Position.z *= 1.0 + push.window.w;
}
