#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/array/solve/solve_inputs.glsl"

// For slots of many foci and for back-propagation: refines the heard factors once, over the whole array and with the
// amplitudes that the constraint allows. One workgroup per slot.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 5) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = 6) buffer Weights { vec4 weights[]; };
// The transducers' drives with the factors so far: real and imaginary part are kept in the drive's own place.
layout(std430, set = 0, binding = 7) buffer Drives { DriveOut drives[]; };

#include "shaders/array/solve/solve_step.glsl"

const uint tile = 5u;  // foci that a thread keeps in registers
const uint each = 4u;  // transducers that a thread keeps in registers
shared vec2 partial[tile * solve_group];

void drive_all(uint base, uint first, uint count) {
  for (uint begin = gl_LocalInvocationIndex; begin < push.transducers; begin += solve_group * each) {
    Source sources[each];
    vec2 sum[each];
    [[unroll]] for (uint k = 0u; k < each; ++k) {
      sources[k] = source_of(min(begin + k * solve_group, push.transducers - 1u));
      sum[k] = vec2(0.0);
    }
    for (uint j = 0u; j < count; ++j) {
      const Place focus = place_of(first + j);
      const vec2 by = factor[j];
      [[unroll]] for (uint k = 0u; k < each; ++k) sum[k] += times(by, ask_of(sources[k], focus));
    }
    [[unroll]] for (uint k = 0u; k < each; ++k) {
      const uint n = begin + k * solve_group;
      if (n >= push.transducers) continue;
      const vec2 drive = bounded(sum[k]);
      drives[base + n] = DriveOut(drive.x, drive.y);
    }
  }
}

void hear_tile(uint base, uint first, uint begin, uint count) {
  const uint thread = gl_LocalInvocationIndex;
  Place places[tile];
  vec2 sum[tile];
  [[unroll]] for (uint i = 0u; i < tile; ++i) {
    places[i] = place_of(first + min(begin + i, count - 1u));
    sum[i] = vec2(0.0);
  }
  for (uint n = thread; n < push.transducers; n += solve_group) {
    const Source source = source_of(n);
    const vec2 drive = vec2(drives[base + n].amplitude, drives[base + n].phase);
    [[unroll]] for (uint i = 0u; i < tile; ++i) {
      const Pair pair = pair_of(source, places[i]);
      sum[i] += times(drive, pair.unit * pair.loud);
    }
  }
  [[unroll]] for (uint i = 0u; i < tile; ++i) partial[i * solve_group + thread] = sum[i];
  barrier();
  if (thread < tile && begin + thread < count) {
    vec2 total = vec2(0.0);
    for (uint t = 0u; t < solve_group; ++t) total += partial[thread * solve_group + t];
    field[begin + thread] = total;
  }
  barrier();
}

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  focus_base = slot.solved;
  focus_first = slot.first;
  focus_count = slot.count;
  const uint base = gl_WorkGroupID.x * push.transducers;
  const uint thread = gl_LocalInvocationIndex;
  if (weighs == 0u) {
    float farthest = 0.0;
    for (uint j = 0u; j < slot.count; ++j) farthest = max(farthest, weights[slot.first + j].x);
    if (farthest < push.still) return;
  }
  const float loudest = loudest_alone();
  for (uint j = thread; j < slot.count; j += solve_group) {
    factor[j] = weights[slot.first + j].zw;
    wanted[j] = gain_of(slot.first + j) * claim_at(j, loudest);
  }
  barrier();
  float sum = 0.0;
  for (uint j = 0u; j < slot.count; ++j) sum += gain_of(slot.first + j);
  forget_moves(slot.count);
  drive_all(base, slot.first, slot.count);
  for (uint begin = 0u; begin < slot.count; begin += tile) hear_tile(base, slot.first, begin, slot.count);
  step_factors(slot.count, true, sum);
  for (uint j = thread; j < slot.count; j += solve_group) {
    weights[slot.first + j].zw = factor[j];
    if (weighs == 0u) weights[slot.first + j].x = moved[j];
  }
}
