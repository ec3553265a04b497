// One step of gs_pat.hpp by a workgroup: moves the factors towards t_j L. All threads call these functions together.
#include "shaders/array/solve/solve_rules.glsl"
#include "shaders/array/solve/solve_near.glsl"

// 0: the step of back_propagation.hpp, whose factors have the magnitudes t_j.
layout(constant_id = 2) const uint weighs = 1u;

shared vec2 factor[solve_most_foci];
shared vec2 field[solve_most_foci];    // their sound at the foci
shared float wanted[solve_most_foci];  // t_j
shared float moved[solve_most_foci];
shared float level;  // L
shared float scale;  // of the new magnitudes
shared vec2 back;    // against what all factors of back-propagation turn
shared bool still;

float new_size(uint j) {
  return weighs == 0u ? wanted[j] : length(factor[j]) * growth(wanted[j] * level, length(field[j]));
}

// What a focus may have at most, with a gain of 1.
float claim_at(uint j, float loudest) { return weighs == 0u ? 1.0 : claim_of(alone(j), loudest); }

vec2 next_factor(uint j) { return turned(min(new_size(j) * scale, push.most_weight), field[j], factor[j]); }

// Call it after a barrier that follows the writes to `field`. `free`: the level is the present one. `sum`: the sum of
// the magnitudes after the step; 0: not fixed. If the step before moved no factor, it sets `still` and leaves the
// factors.
void step_factors(uint count, bool free, float sum) {
  const uint thread = gl_LocalInvocationIndex;
  if (thread == 0u) {
    float farthest = 0.0;
    float heard = 0.0;
    float asked = 0.0;
    for (uint j = 0u; j < count; ++j) {
      farthest = max(farthest, moved[j]);
      heard += length(field[j]);
      asked += wanted[j];
    }
    still = farthest < push.still;
    if (free) level = asked > 0.0 ? heard / asked : 0.0;
    scale = 1.0;
    if (weighs != 0u) {
      float total = 0.0;
      for (uint j = 0u; j < count; ++j) total += new_size(j);
      if (sum > 0.0 && total > 0.0) scale = sum / total;
    } else {
      vec2 turns = vec2(0.0);
      for (uint j = 0u; j < count; ++j) turns += times(vec2(factor[j].x, -factor[j].y), next_factor(j));
      back = turned(1.0, vec2(turns.x, -turns.y), vec2(1.0, 0.0));
    }
  }
  barrier();
  if (!still) {
    for (uint j = thread; j < count; j += solve_group) {
      const vec2 next = next_factor(j);
      moved[j] = length((weighs == 0u ? times(next, back) : next) - factor[j]);
      factor[j] = next;
    }
  }
  barrier();
}

void forget_moves(uint count) {
  for (uint j = gl_LocalInvocationIndex; j < count; j += solve_group) moved[j] = 1e30;
}
