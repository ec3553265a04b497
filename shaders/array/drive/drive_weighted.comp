#version 460
#extension GL_GOOGLE_include_directive : require
#define DRIVE_WEIGHTED
#include "shaders/array/drive/drive_sum.glsl"

layout(local_size_x = 32) in;

void main() { drive_slot(gl_WorkGroupID.x); }
