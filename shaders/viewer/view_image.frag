#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

// A flat image in the world, from pixels in a buffer. Between pixel centres, colours are interpolated.
layout(std430, set = 0, binding = view_pixels) readonly buffer Pixels { uint pixels[]; };
layout(location = 0) in vec2 place;
layout(location = 0) out vec4 colour;

vec4 pixel(vec2 at) {
  const vec2 inside = clamp(at, vec2(0.0), push.style.yz - 1.0);
  return unpackUnorm4x8(pixels[uint(push.style.x) + uint(inside.y) * uint(push.style.y) + uint(inside.x)]);
}

void main() {
  const vec2 at = place * push.style.yz - 0.5;
  const vec2 first = floor(at);
  const vec2 part = at - first;
  const vec4 above = mix(pixel(first), pixel(first + vec2(1.0, 0.0)), part.x);
  const vec4 below = mix(pixel(first + vec2(0.0, 1.0)), pixel(first + vec2(1.0, 1.0)), part.x);
  colour = mix(above, below, part.y);
  colour.a *= push.style.w;
}
