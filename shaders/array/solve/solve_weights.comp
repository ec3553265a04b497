#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/array/solve/solve_inputs.glsl"

// The factors of each slot's foci from its matrix, for slots of many foci and for back-propagation: one workgroup per
// slot, a thread per row (or two). gs_pat.hpp says why few foci have a kernel of their own.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 5) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = 6) writeonly buffer Weights { vec4 weights[]; };

#include "shaders/array/solve/solve_step.glsl"

void multiply(uint base, uint count) {
  for (uint row = gl_LocalInvocationIndex; row < count; row += solve_group) {
    vec2 sum = vec2(0.0);
    for (uint column = 0u; column < count; ++column)
      sum += times(matrices[base + column * count + row], factor[column]);
    field[row] = sum;
  }
  barrier();
}

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  focus_base = slot.solved;
  focus_first = slot.first;
  focus_count = slot.count;
  const uint count = slot.count;
  const uint base = slot.solved;
  const uint thread = gl_LocalInvocationIndex;

  // As if each focus sounded alone.
  const float loudest = loudest_alone();
  float shares = 0.0;
  for (uint j = 0u; j < count; ++j) {
    const float own = alone(j);
    shares += own > 0.0 ? claim_at(j, loudest) / own : 0.0;
  }
  bool differ = false;
  for (uint j = 0u; j < count; ++j) differ = differ || gain_of(slot.first + j) != 1.0;
  for (uint j = thread; j < count; j += solve_group) {
    const float own = alone(j);
    const float share = own > 0.0 ? claim_at(j, loudest) / own : 0.0;
    const float size = weighs != 0u && shares > 0.0 ? min(share * float(count) / shares, push.most_weight) : 1.0;
    factor[j] = size * first_phase(slot.first + j);
    wanted[j] = claim_at(j, loudest);
  }
  forget_moves(count);
  barrier();
  for (uint i = 0u; i < push.steps; ++i) {
    multiply(base, count);
    step_factors(count, true, float(count));
    if (still) break;
  }

  vec2 plain[2];
  for (uint k = 0u; k < 2u; ++k) plain[k] = factor[min(thread + k * solve_group, solve_most_foci - 1u)];
  if (differ) {
    multiply(base, count);
    if (thread == 0u) {
      float heard = 0.0;
      float asked = 0.0;
      for (uint j = 0u; j < count; ++j) {
        heard += length(field[j]);
        asked += wanted[j];
      }
      level = asked > 0.0 ? heard / asked : 0.0;
    }
    barrier();
    for (uint j = thread; j < count; j += solve_group) {
      wanted[j] *= gain_of(slot.first + j);
      factor[j] = gain_of(slot.first + j) * (weighs == 0u ? first_phase(slot.first + j) : factor[j]);
    }
    forget_moves(count);
    barrier();
    for (uint i = 0u; i < push.steps; ++i) {
      multiply(base, count);
      step_factors(count, false, 0.0);
      if (still) break;
    }
  }
  for (uint k = 0u; k < 2u; ++k) {
    const uint j = thread + k * solve_group;
    if (j >= count) continue;
    // solve_refine keeps there how far back-propagation has moved the factor. No drive needs the plain ones then.
    if (weighs == 0u && push.constraint != drive_normalise) plain[k] = vec2(1.0, 0.0);
    weights[slot.first + j] = vec4(plain[k], factor[j]);
  }
}
