// The quad around a line with round ends: shared by view_stroke.vert and view_edge.vert, drawn by view_stroke.frag.
#ifndef PALPA_SHADERS_VIEW_LINE_H
#define PALPA_SHADERS_VIEW_LINE_H

layout(location = 0) flat out vec4 ends;  // both ends, pixels
layout(location = 1) flat out vec4 line_colour;
layout(location = 2) flat out float half_width;

// Corner `corner` (0..5) of the two triangles that cover the line between two points in pixels. The depths are those of
// the ends; larger is nearer.
void line_corner(uint corner, vec2 a, vec2 b, float depth_a, float depth_b) {
  const float reach = half_width + 1.0;  // room for the soft edge
  const vec2 along = b - a;
  const float span = length(along);
  const vec2 t = span > 1e-6 ? along / span : vec2(1.0, 0.0);
  const vec2 s = vec2(-t.y, t.x);
  const bool at_b = corner == 1u || corner == 2u || corner == 4u;
  const float side = corner == 2u || corner == 4u || corner == 5u ? 1.0 : -1.0;
  const vec2 pixel = (at_b ? b + t * reach : a - t * reach) + s * side * reach;
  ends = vec4(a, b) + push.style.zwzw;  // in the coordinates of gl_FragCoord
  gl_Position = vec4(pixel / push.window.xy * 2.0 - 1.0, clamp(at_b ? depth_b : depth_a, 0.0, 1.0), 1.0);
}

// The same for a line in the world, cut where it passes behind the viewer.
void world_line_corner(uint corner, vec3 from, vec3 to) {
  vec4 a = to_clip(from);
  vec4 b = to_clip(to);
  const float nearest = 1e-4;  // metres in front of the eye
  if (a.w < nearest && b.w < nearest) {
    ends = vec4(0.0);
    gl_Position = nowhere;
    return;
  }
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  const float bias = 1.0 + push.window.w;
  line_corner(corner, (a.xy / a.w * 0.5 + 0.5) * push.window.xy, (b.xy / b.w * 0.5 + 0.5) * push.window.xy,
              a.z / a.w * bias, b.z / b.w * bias);
}

#endif
