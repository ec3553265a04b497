#version 460
#extension GL_GOOGLE_include_directive : require
// For tests: drive_sum whose sines turn into NaN where a GPU would promise nothing for them.
float promised(float x) { return abs(x) <= 3.14159265 ? x : uintBitsToFloat(0x7fc00000u); }
#define cos(x) cos(promised(x))
#define sin(x) sin(promised(x))
#include "drive_sum.glsl"
