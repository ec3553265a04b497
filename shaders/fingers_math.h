// The arithmetic of fingers, for the shaders and their twin; see exact_math.h.
#ifndef PALPA_SHADERS_FINGERS_MATH_H
#define PALPA_SHADERS_FINGERS_MATH_H
#include "exact_math.h"
PALPA_SHADER_BEGIN

// Whether two contacts are no farther apart than the finger gap; `limit` is its square.
PALPA_FN bool in_reach(Float3 a, Float3 b, float limit) {
  PALPA_EXACT float x = a.x - b.x;
  PALPA_EXACT float y = a.y - b.y;
  PALPA_EXACT float z = a.z - b.z;
  PALPA_EXACT float square = x * x + y * y + z * z;
  return square <= limit;
}

PALPA_SHADER_END
#endif
