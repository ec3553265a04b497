// The arithmetic of clusters, for the shaders, their twin and the code that allocates their memory; see exact_math.h.
#ifndef PALPA_SHADERS_CLUSTERS_MATH_H
#define PALPA_SHADERS_CLUSTERS_MATH_H
#include "shaders/shared/exact_math.h"
PALPA_SHADER_BEGIN

// Whether two contacts are no farther apart than the finger gap; `limit` is its square.
PALPA_FN bool in_reach(Float3 a, Float3 b, float limit) {
  PALPA_EXACT float x = a.x - b.x;
  PALPA_EXACT float y = a.y - b.y;
  PALPA_EXACT float z = a.z - b.z;
  PALPA_EXACT float square = x * x + y * y + z * z;
  return square <= limit;
}

// Number of slots of the hash table of tiles for this many contacts: at least 1.5 times as many, in groups, and no
// multiple of three; see clusters_table.glsl.
PALPA_CONST table_group = 64u;

PALPA_FN uint table_slots(uint contacts) {
  const uint groups = contacts * 3u / (2u * table_group) + 2u;
  return (groups % 3u == 0u ? groups + 1u : groups) * table_group;
}

// Capacity of the list of pairs of blocks that touch. It suffices for randomly scattered contacts, and is at most 128
// MiB.
PALPA_FN uint links_room(uint contacts) {
  const uint most = 1u << 24u;
  return contacts < most / 6u ? contacts * 6u : most;
}

PALPA_SHADER_END
#endif
