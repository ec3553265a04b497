// The arithmetic that makes decisions, in the pieces that all passes share. The shaders and their twins include it, so
// that both give the same answer to "in reach?" and "which cell?". PALPA_EXACT keeps a compiler from fusing or
// reordering; the C++ side is built with -ffp-contract=off. The code uses only what both C++ and GLSL understand.
#ifndef PALPA_SHADERS_EXACT_MATH_H
#define PALPA_SHADERS_EXACT_MATH_H
#include "shaders/shared/shared.h"

#ifdef __cplusplus
#include <bit>
#include <cmath>
#define PALPA_EXACT
PALPA_SHADER_BEGIN
using std::sqrt;
inline uint floatBitsToUint(float value) {
  return std::bit_cast<uint>(value);
}
#else
#define PALPA_EXACT precise
PALPA_SHADER_BEGIN
#endif

struct Float3 {
  float x, y, z;
};

PALPA_FN Float3 xyz_of(vec4 v) {
  Float3 r;
  r.x = v.x;
  r.y = v.y;
  r.z = v.z;
  return r;
}

PALPA_FN Float3 minus(Float3 a, Float3 b) {
  PALPA_EXACT Float3 d;
  d.x = a.x - b.x;
  d.y = a.y - b.y;
  d.z = a.z - b.z;
  return d;
}

PALPA_FN float dot3(Float3 a, Float3 b) {
  PALPA_EXACT float sum = a.x * b.x + a.y * b.y + a.z * b.z;
  return sum;
}

// A product that no compiler may fuse with the sum it is part of.
PALPA_FN float product(float a, float b) {
  PALPA_EXACT float p = a * b;
  return p;
}

// Checks the bits: a compiler may assume that comparisons never meet a NaN.
PALPA_FN bool is_finite(float value) {
  return (floatBitsToUint(value) & 0x7f800000u) != 0x7f800000u;
}

PALPA_FN Float3 scaled(Float3 a, float factor) {
  PALPA_EXACT Float3 r;
  r.x = a.x * factor;
  r.y = a.y * factor;
  r.z = a.z * factor;
  return r;
}

PALPA_FN Float3 cross3(Float3 a, Float3 b) {
  PALPA_EXACT Float3 r;
  r.x = a.y * b.z - a.z * b.y;
  r.y = a.z * b.x - a.x * b.z;
  r.z = a.x * b.y - a.y * b.x;
  return r;
}

// r turned by the unit quaternion (q, w). The identity (0, 0, 0, 1) leaves every bit as it is.
PALPA_FN Float3 turned(Float3 q, float w, Float3 r) {
  PALPA_EXACT Float3 t = scaled(cross3(q, r), 2.0f);
  PALPA_EXACT Float3 u = cross3(q, t);
  PALPA_EXACT Float3 sum;
  sum.x = r.x + (w * t.x + u.x);
  sum.y = r.y + (w * t.y + u.y);
  sum.z = r.z + (w * t.z + u.z);
  return sum;
}

PALPA_SHADER_END
#endif
