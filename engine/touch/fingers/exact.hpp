// The arithmetic of fingers: what they share with the kernels (shaders/shared/exact_math.h), and more of the same.
// Decisions are made in single precision, and no compiler fuses a product with a sum: the engine is built with
// -ffp-contract=off.
#pragma once

#include <cmath>

#include "shaders/shared/exact_math.h"

// A constant of the rules, or what is compared with it. tests/tools/split_sensitivity.cpp scales it by its name.
#ifndef PALPA_TUNED
#define PALPA_TUNED(name, value) value
#endif

namespace palpa::touch {

using shader::Float3;

struct Float2 {
  float x, y;
};

inline Float3 unit(Float3 a) {
  return scaled(a, 1.0F / std::sqrt(dot3(a, a)));
}

inline Float3 plus(Float3 a, Float3 b) {
  Float3 r;
  r.x = a.x + b.x;
  r.y = a.y + b.y;
  r.z = a.z + b.z;
  return r;
}

inline float square_apart(Float3 a, Float3 b) {
  const Float3 d = minus(a, b);
  return dot3(d, d);
}

/// The cosine between the direction `normal` at `from` and the way to `to`.
inline float cosine_of_way(Float3 from, Float3 normal, Float3 to) {
  const Float3 way = minus(to, from);
  const float square = dot3(way, way);
  float cosine = square > 0.0F ? dot3(way, normal) / std::sqrt(square) : 0.0F;
  return cosine;
}

}  // namespace palpa::touch
