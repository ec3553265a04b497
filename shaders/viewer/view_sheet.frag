#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_sheet.h"

layout(std430, set = 0, binding = sheet_glyphs) readonly buffer Glyphs { uint coverages[]; };

layout(location = 0) in vec2 texel;
layout(location = 1) in vec4 tint;
layout(location = 0) out vec4 colour;

// Glyphs are drawn pixel by pixel without scaling, so the nearest texel is the right one.
void main() {
  float coverage = 1.0;
  if (texel.x >= 0.0) {
    const uint at = uint(texel.y) * uint(push.size.z) + uint(texel.x);
    coverage = float(coverages[at >> 2] >> ((at & 3u) * 8u) & 255u) / 255.0;
  }
  colour = vec4(tint.rgb, tint.a * coverage);
}
