// Shared by engine/touch/ and the kernels of contacts: fingers of the frame before that are about to end. Skin around
// such a finger may be its contact although it lies beyond the edges of its solid's shell.
#ifndef PALPA_SHADERS_REACH_H
#define PALPA_SHADERS_REACH_H
#include "shaders/shared/exact_math.h"
PALPA_SHADER_BEGIN

PALPA_CONST reach_most_fingers = 64u;  // as touch::max_fingers
// No finger; and in ContactsPush::elapsed_us: there is no table.
PALPA_CONST reach_none = 0xffffffffu;
// How far beyond the edges, in metres.
PALPA_CONST_FLOAT reach_edge_m = 0.5e-3f;

struct ReachingFinger {
  vec4 velocity;  // m/s
  vec4 centre;    // of its samples in the frame before; w: the square of its reach around them
  vec4 inward;    // unit: the mean of its skin's outward normals, which point into the solid
  uint solid;
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(ReachingFinger, 64);
PALPA_CHECK_OFFSET(ReachingFinger, solid, 48);

struct ReachTable {
  uint count;
  uint unused0;
  uint unused1;
  uint unused2;
  ReachingFinger fingers[reach_most_fingers];
};
PALPA_CHECK_SIZE(ReachTable, 16 + 64 * 64);
PALPA_CHECK_OFFSET(ReachTable, fingers, 16);

PALPA_FN float seconds_of(uint us) {
  PALPA_EXACT float s = float(us) * 1.0e-6f;
  return s;
}

// Where a point was in the frame before, if it has moved with a finger.
PALPA_FN Float3 moved_back(Float3 place, vec4 velocity, float elapsed_s) {
  PALPA_EXACT Float3 r;
  r.x = place.x - velocity.x * elapsed_s;
  r.y = place.y - velocity.y * elapsed_s;
  r.z = place.z - velocity.z * elapsed_s;
  return r;
}

// The place at which skin is tested again: deeper by the reach beyond an edge, or as much shallower.
PALPA_FN Float3 shifted(Float3 place, vec4 inward, bool deeper) {
  const float shift = deeper ? reach_edge_m : -reach_edge_m;
  PALPA_EXACT Float3 r;
  r.x = place.x + inward.x * shift;
  r.y = place.y + inward.y * shift;
  r.z = place.z + inward.z * shift;
  return r;
}

PALPA_FN bool is_around(ReachingFinger finger, Float3 place, float elapsed_s) {
  const Float3 before = moved_back(place, finger.velocity, elapsed_s);
  PALPA_EXACT float x = before.x - finger.centre.x;
  PALPA_EXACT float y = before.y - finger.centre.y;
  PALPA_EXACT float z = before.z - finger.centre.z;
  PALPA_EXACT float square = x * x + y * y + z * z;
  return square <= finger.centre.w;
}

PALPA_SHADER_END
#endif
