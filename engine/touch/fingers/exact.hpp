// The arithmetic of fingers: what they share with the kernels (shaders/shared/exact_math.h), and more of the same.
// Decisions are made in single precision, and no compiler fuses a product with a sum: the engine is built with
// -ffp-contract=off.
#pragma once

#include <cmath>

#include "shaders/shared/exact_math.h"

namespace palpa::touch {

using shader::Float3;
using shader::product;

struct Float2 {
  float x, y;
};

inline float plus(float a, float b) {
  return a + b;
}

inline float less(float a, float b) {
  return a - b;
}

inline Float3 unit(Float3 a) {
  return scaled(a, 1.0F / std::sqrt(dot3(a, a)));
}

}  // namespace palpa::touch
