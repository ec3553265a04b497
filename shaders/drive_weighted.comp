#version 460
#extension GL_GOOGLE_include_directive : require
#define DRIVE_WEIGHTED
#include "drive_sum.glsl"
