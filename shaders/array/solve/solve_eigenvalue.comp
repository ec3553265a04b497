#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/array/solve/solve_inputs.glsl"

// eigenvalue.hpp: the phases of an eigenvector, and the factors that give each focus its loudness. One workgroup per
// slot. A thread has a row of the matrix, or two, and no other thread reads these rows, which become the system. The
// system needs no exchange of rows: R is nearly its own conjugate transpose, and positive.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 5) buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = 6) writeonly buffer Weights { vec4 weights[]; };

#include "shaders/array/solve/solve_rules.glsl"
#include "shaders/array/solve/solve_near.glsl"

shared float own[solve_most_foci];    // R_jj
shared float gain[solve_most_foci];   // t_j
shared vec2 vector[solve_most_foci];  // v
shared vec2 sent[solve_most_foci];    // t_k v_k / R_kk
shared float largest[solve_group];    // of each thread
shared float moved[solve_group];
shared vec2 pivots[solve_most_foci];  // a row of the system
shared vec2 plain[solve_most_foci];   // b, then c, for equal gains
shared vec2 heard[solve_most_foci];   // and with the gains

float largest_of_all() {
  float all = 0.0;
  for (uint t = 0u; t < solve_group; ++t) all = max(all, largest[t]);
  return all;
}
float moved_of_all() {
  float all = 0.0;
  for (uint t = 0u; t < solve_group; ++t) all = max(all, moved[t]);
  return all;
}

// Call it after a barrier that follows the writes to `gain`.
void find_vector() {
  const uint thread = gl_LocalInvocationIndex;
  for (uint j = thread; j < focus_count; j += solve_group) vector[j] = first_phase(focus_first + j);
  for (uint i = 0u; i < push.steps; ++i) {
    for (uint j = thread; j < focus_count; j += solve_group)
      sent[j] = own[j] > 0.0 ? vector[j] * (gain[j] / own[j]) : vec2(0.0);
    barrier();
    vec2 next[2];
    next[0] = next[1] = vec2(0.0);
    for (uint k = 0u; k < 2u; ++k) {
      const uint row = thread + k * solve_group;
      if (row >= focus_count) continue;
      for (uint column = 0u; column < focus_count; ++column) next[k] += times(at(row, column), sent[column]);
    }
    largest[thread] = max(length(next[0]), length(next[1]));
    barrier();
    const float size = largest_of_all();
    if (!(size > 0.0)) break;
    moved[thread] = 0.0;
    for (uint k = 0u; k < 2u; ++k) {
      const uint row = thread + k * solve_group;
      if (row >= focus_count) continue;
      next[k] /= size;
      moved[thread] = max(moved[thread], length(next[k] - vector[row]));
      vector[row] = next[k];
    }
    barrier();
    if (moved_of_all() < push.still) break;
  }
  barrier();
}

// b_j of the present gains.
vec2 wanted_at(uint j) { return turned(gain[j], vector[j], vec2(1.0, 0.0)); }

// R becomes (R / mean R_jj + ridge), and its lower triangle zero; plain and heard turn with it.
void eliminate(float unit) {
  const uint thread = gl_LocalInvocationIndex;
  for (uint row = thread; row < focus_count; row += solve_group) {
    for (uint column = 0u; column < focus_count; ++column) {
      const uint entry = focus_base + column * focus_count + row;
      matrices[entry] = matrices[entry] * unit + vec2(column == row ? solve_ridge : 0.0, 0.0);
    }
  }
  for (uint k = 0u; k < focus_count; ++k) {
    if (thread == k % solve_group) {
      for (uint column = k; column < focus_count; ++column) pivots[column] = at(k, column);
    }
    barrier();
    const vec2 inverse = vec2(pivots[k].x, -pivots[k].y) / max(dot(pivots[k], pivots[k]), 1e-30);
    for (uint row = thread; row < focus_count; row += solve_group) {
      if (row <= k) continue;
      const vec2 part = times(at(row, k), inverse);
      for (uint column = k + 1u; column < focus_count; ++column)
        matrices[focus_base + column * focus_count + row] -= times(part, pivots[column]);
      plain[row] -= times(part, plain[k]);
      heard[row] -= times(part, heard[k]);
    }
    barrier();
  }
}

// From the last row to the first.
void put_in() {
  const uint thread = gl_LocalInvocationIndex;
  for (uint left = focus_count; left > 0u; --left) {
    const uint k = left - 1u;
    if (thread == k % solve_group) {
      const vec2 pivot = at(k, k);
      const vec2 inverse = vec2(pivot.x, -pivot.y) / max(dot(pivot, pivot), 1e-30);
      plain[k] = times(plain[k], inverse);
      heard[k] = times(heard[k], inverse);
    }
    barrier();
    for (uint row = thread; row < k; row += solve_group) {
      plain[row] -= times(at(row, k), plain[k]);
      heard[row] -= times(at(row, k), heard[k]);
    }
  }
  barrier();
}

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  focus_base = slot.solved;
  focus_first = slot.first;
  focus_count = slot.count;
  const uint thread = gl_LocalInvocationIndex;
  for (uint j = thread; j < focus_count; j += solve_group) {
    own[j] = alone(j);
    gain[j] = 1.0;
  }
  barrier();
  bool differ = false;
  float mean = 0.0;
  for (uint j = 0u; j < focus_count; ++j) {
    differ = differ || gain_of(focus_first + j) != 1.0;
    mean += own[j] / float(focus_count);
  }
  find_vector();
  for (uint j = thread; j < focus_count; j += solve_group) {
    plain[j] = heard[j] = wanted_at(j);
    gain[j] = gain_of(focus_first + j);
  }
  barrier();
  if (differ) {
    find_vector();
    for (uint j = thread; j < focus_count; j += solve_group) heard[j] = wanted_at(j);
    barrier();
  }
  eliminate(mean > 0.0 ? 1.0 / mean : 0.0);
  put_in();
  for (uint j = thread; j < focus_count; j += solve_group) weights[focus_first + j] = vec4(plain[j], heard[j]);
}
