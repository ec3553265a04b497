#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/viewer/view_sheet.h"

layout(std430, set = 0, binding = sheet_corners) readonly buffer Corners { SheetCorner corners[]; };

layout(location = 0) out vec2 texel;
layout(location = 1) out vec4 tint;

void main() {
  const SheetCorner corner = corners[gl_VertexIndex];
  texel = corner.place.zw;
  tint = corner.colour;
  gl_Position = vec4(corner.place.xy / push.size.xy * 2.0 - 1.0, 1.0, 1.0);
}
