#version 460
#extension GL_GOOGLE_include_directive : require
#define SOLVE_MIRRORED
#include "solve_matrix.glsl"
