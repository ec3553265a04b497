// The arithmetic of contacts, for the shaders and their twin; see exact_math.h.
#ifndef PALPA_SHADERS_CONTACTS_MATH_H
#define PALPA_SHADERS_CONTACTS_MATH_H
#include "shaders/shared/exact_math.h"
PALPA_SHADER_BEGIN

// Eq. (1)'s (x_m - x) . n_m for the plane dot(n, x) = offset.
PALPA_FN float plane_depth(Float3 normal, float offset, Float3 point) {
  PALPA_EXACT float depth = offset - (normal.x * point.x + normal.y * point.y + normal.z * point.z);
  return depth;
}

PALPA_SHADER_END
#endif
