#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_scene.h"

layout(location = 0) in vec2 place;
layout(location = 1) flat in vec4 disc_colour;
layout(location = 2) flat in float radius;
layout(location = 3) flat in float ball;
layout(location = 0) out vec4 colour;

// Soft edges that need no sorting: the coverage sets how many of a pixel's samples are written. Vulkan's alpha to
// coverage does not specify which samples are written, and drivers differ. A pixel with one sample is blended instead.
int samples_of(float coverage) { return (1 << int(ceil(coverage * float(view_samples)))) - 1; }

void main() {
  const float r = length(place);
  // Pixels per unit of r: exact for discs that face the viewer, measured for foreshortened discs.
  const float scale = ball > 0.5 ? radius : 1.0 / max(fwidth(r), 1e-6);
  const float coverage = clamp((1.0 - r) * scale + 0.5, 0.0, 1.0);
  if (coverage <= 0.0) discard;
  // A dark rim keeps pale colours readable on white; a light from the upper left makes the disc look like a ball.
  const float rim = push.style.x > 0.0 ? clamp((r - 1.0) * scale + push.style.x + 0.5, 0.0, 1.0) : 0.0;
  const float light = ball > 0.5 && radius > 3.0 ? 1.0 + 0.16 * dot(place, vec2(-0.5, -0.7)) : 1.0;
  colour = vec4(mix(clamp(disc_colour.rgb * light, 0.0, 1.0), disc_colour.rgb * 0.45, rim), coverage * push.style.z);
  gl_SampleMask[0] = samples_of(colour.a);
}
