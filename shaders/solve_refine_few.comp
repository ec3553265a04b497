#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "solve_inputs.glsl"

// The heard factors, refined over the whole array for amplitudes as the constraint makes them, where foci are few: one
// workgroup per slot, a transducer and all foci at a time.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = solve_matrices) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = drive_weights) buffer Weights { vec4 weights[]; };

#include "solve_step.glsl"

shared vec2 partial[most * solve_group];

// What the foci hear of the bounded drive.
void hear(Place places[most], uint count) {
  const uint thread = gl_LocalInvocationIndex;
  vec2 by[most];
  vec2 sum[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    by[j] = j < count ? factor[j] : vec2(0.0);
    sum[j] = vec2(0.0);
  }
  for (uint n = thread; n < push.transducers; n += solve_group) {
    const Source source = source_of(n);
    vec2 asks = vec2(0.0);
    vec2 gives[most];
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const Pair pair = pair_of(source, places[j]);
      asks += times(by[j], vec2(pair.asked * pair.unit.x, -(pair.asked * pair.unit.y)));
      gives[j] = pair.unit * pair.loud;
    }
    const vec2 does = bounded(asks);
    [[unroll]] for (uint j = 0u; j < most; ++j) sum[j] += times(does, gives[j]);
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) partial[j * solve_group + thread] = sum[j];
  barrier();
  if (thread < count) {
    vec2 total = vec2(0.0);
    for (uint t = 0u; t < solve_group; ++t) total += partial[thread * solve_group + t];
    field[thread] = total;
  }
  barrier();
}

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  const uint thread = gl_LocalInvocationIndex;
  Place places[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) places[j] = place_of(slot.first + min(j, slot.count - 1u));
  const float loudest = loudest_alone(slot.solved, slot.count);
  if (thread < slot.count) {
    factor[thread] = weights[slot.first + thread].zw;
    wanted[thread] = gain_of(slot.first + thread) * claim_of(alone(slot.solved, slot.count, thread), loudest);
  }
  if (thread == 0u) halfway = slot.count <= solve_few;
  float sum = 0.0;
  for (uint j = 0u; j < slot.count; ++j) sum += gain_of(slot.first + j);
  forget_moves(slot.count);
  barrier();
  for (uint i = 0u; i < push.refinings; ++i) {
    hear(places, slot.count);
    step_factors(slot.count, true, sum);
    forget_moves(slot.count);
    barrier();
  }
  if (thread < slot.count) weights[slot.first + thread].zw = factor[thread];
}
