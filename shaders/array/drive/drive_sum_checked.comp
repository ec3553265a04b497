#version 460
#extension GL_GOOGLE_include_directive : require
// For tests: drive_sum whose sines return NaN outside the range of their polynomial.
float only_quarter(float x) { return abs(x) <= 0.25 ? x : uintBitsToFloat(0x7fc00000u); }
#define promised(x) only_quarter(x)
#include "shaders/array/drive/drive_sum.glsl"

layout(local_size_x = 32) in;

void main() { drive_slot(gl_WorkGroupID.x); }
