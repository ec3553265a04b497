// The arithmetic of fingers, for the shaders, their twin and whoever makes their memory; see exact_math.h.
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

// Slots of the hash table of tiles for so many contacts: half as many again at least, in groups of eight, and no
// multiple of three; see fingers_table.glsl.
PALPA_FN uint table_slots(uint contacts) {
  const uint groups = contacts * 3u / 16u + 2u;
  return (groups % 3u == 0u ? groups + 1u : groups) * 8u;
}

PALPA_SHADER_END
#endif
