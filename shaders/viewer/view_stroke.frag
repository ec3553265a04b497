#version 460

layout(location = 0) flat in vec4 ends;
layout(location = 1) flat in vec4 line_colour;
layout(location = 2) flat in float half_width;
layout(location = 0) out vec4 colour;

void main() {
  const vec2 along = ends.zw - ends.xy;
  const vec2 p = gl_FragCoord.xy - ends.xy;
  const float at = clamp(dot(p, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
  const float coverage = clamp(half_width + 0.5 - length(p - at * along), 0.0, 1.0);
  colour = vec4(line_colour.rgb, line_colour.a * coverage);
}
