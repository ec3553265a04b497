#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "solve_inputs.glsl"

// The heard factors of few foci, evened out over the whole array for amplitudes as the constraint makes them
// (even_out.hpp, hearing.hpp): one workgroup per slot, a transducer and all foci at a time.
layout(local_size_x = 16) in;

layout(std430, set = 0, binding = solve_matrices) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = drive_weights) buffer Weights { vec4 weights[]; };

#include "solve_rules.glsl"
#include "solve_near.glsl"

shared vec2 partial[most * most * solve_refine_few_group];
shared vec2 tried[most];             // factors
shared vec2 field[most];             // what they give
shared vec2 factor[most];            // those that were the best so far,
shared vec2 heard[most];             // what they give
shared float wanted[most];           // t_j
shared vec2 slopes[most * most];     // [row * count + column]
shared float normal[most * most];
shared float rest[most];
shared float step[most];
shared float miss[most];

// Sums of sums[entry * solve_refine_few_group + thread] over the threads, in their order.
vec2 total_of(uint entry) {
  vec2 total = vec2(0.0);
  for (uint t = 0u; t < solve_refine_few_group; ++t) total += partial[entry * solve_refine_few_group + t];
  return total;
}

// What the foci hear of the tried factors, sums bounded by `bound`.
void hear(Place places[most], float bound) {
  const uint thread = gl_LocalInvocationIndex;
  vec2 by[most];
  vec2 sum[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    by[j] = j < focus_count ? tried[j] : vec2(0.0);
    sum[j] = vec2(0.0);
  }
  for (uint n = thread; n < push.transducers; n += solve_refine_few_group) {
    const Source source = source_of(n);
    vec2 asks = vec2(0.0);
    vec2 gives[most];
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const Pair pair = pair_of(source, places[j]);
      asks += times(by[j], vec2(pair.asked * pair.unit.x, -(pair.asked * pair.unit.y)));
      gives[j] = pair.unit * pair.loud;
    }
    const float size = max(length(asks), bound);
    const vec2 does = size > 0.0 ? asks / size : vec2(0.0);
    [[unroll]] for (uint j = 0u; j < most; ++j) sum[j] += times(does, gives[j]);
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) partial[j * solve_refine_few_group + thread] = sum[j];
  barrier();
  if (thread < focus_count) field[thread] = total_of(thread);
  barrier();
}

// How what the foci hear follows the factors, each row over what its focus is to hear.
void find_slopes(Place places[most], float bound, float level) {
  const uint thread = gl_LocalInvocationIndex;
  vec2 by[most];
  vec2 turn[most];
  vec2 sum[most * most];
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const bool there = j < focus_count;
    const uint i = min(j, focus_count - 1u);
    const float loud = length(heard[i]);
    const float asked = wanted[i] * level;
    by[j] = there ? factor[i] : vec2(0.0);
    turn[j] = there && loud > 0.0 && asked > 0.0 ? vec2(heard[i].x, -heard[i].y) / (loud * asked) : vec2(0.0);
    [[unroll]] for (uint q = 0u; q < most; ++q) sum[j * most + q] = vec2(0.0);
  }
  for (uint n = thread; n < push.transducers; n += solve_refine_few_group) {
    const Source source = source_of(n);
    vec2 total = vec2(0.0);
    vec2 asks[most];
    vec2 gives[most];
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const Pair pair = pair_of(source, places[j]);
      asks[j] = vec2(pair.asked * pair.unit.x, -(pair.asked * pair.unit.y));
      gives[j] = pair.unit * pair.loud;
      total += times(by[j], asks[j]);
    }
    const float size = length(total);
    const vec2 unit = size > 0.0 ? total / size : vec2(0.0);
    const float steep = 1.0 / max(max(size, bound), 1e-30);
    const vec2 back = vec2(unit.x, -unit.y) * steep;
    [[unroll]] for (uint j = 0u; j < most; ++j) asks[j] = times(back, asks[j]);
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      vec2 give = times(turn[j], times(gives[j], unit));
      // Where the sum is bounded only the part across its own direction counts.
      if (size > bound) give.x = 0.0;
      [[unroll]] for (uint q = 0u; q < most; ++q) sum[j * most + q] += times(give, asks[q]);
    }
  }
  [[unroll]] for (uint e = 0u; e < most * most; ++e) partial[e * solve_refine_few_group + thread] = sum[e];
  barrier();
  for (uint e = thread; e < most * most; e += solve_refine_few_group) {
    const uint row = e / most;
    const uint column = e % most;
    if (row < focus_count && column < focus_count) slopes[row * focus_count + column] = total_of(e);
  }
  barrier();
}

// The damped step of even_out.hpp from `factor` to `tried`.
void step_even(float damping) {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = focus_count;
  for (uint e = thread; e < count * count; e += solve_refine_few_group) {
    const uint a = e / count;
    const uint b = e % count;
    float sum = 0.0;
    for (uint q = 0u; q < count; ++q) sum += dot(slopes[a * count + q], slopes[b * count + q]);
    normal[e] = sum;
  }
  barrier();
  float trace = 0.0;
  for (uint a = 0u; a < count; ++a) trace += normal[a * count + a];
  barrier();
  if (thread < count) {
    normal[thread * count + thread] += max(damping * trace / float(count), 1e-30);
    rest[thread] = miss[thread];
  }
  barrier();
  for (uint k = 0u; k + 1u < count; ++k) {
    if (thread > k && thread < count) {
      const float part = normal[thread * count + k] / normal[k * count + k];
      for (uint j = k + 1u; j < count; ++j) normal[thread * count + j] -= part * normal[k * count + j];
      rest[thread] -= part * rest[k];
    }
    barrier();
  }
  for (uint left = count; left > 0u; --left) {
    const uint k = left - 1u;
    const float found = rest[k] / normal[k * count + k];
    if (thread < k) rest[thread] -= normal[thread * count + k] * found;
    if (thread == k) step[k] = found;
    barrier();
  }
  if (thread < count) {
    vec2 sum = factor[thread];
    for (uint a = 0u; a < count; ++a)
      sum += vec2(slopes[a * count + thread].x, -slopes[a * count + thread].y) * step[a];
    tried[thread] = sum;
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
  const uint count = slot.count;
  Place places[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) places[j] = place_of(slot.first + min(j, count - 1u));
  const float loudest = loudest_alone();
  if (thread < count) {
    tried[thread] = weights[slot.first + thread].zw;
    wanted[thread] = target_of(thread, loudest);
  }
  barrier();
  float asked = 0.0;
  for (uint j = 0u; j < count; ++j) asked += wanted[j];

  // Under `uniform` first as it is, then from the bound of `clamp` down.
  const bool clamps = push.constraint == drive_clamp;
  uint stage = 0u;
  float bound = clamps ? 1.0 : 0.0;
  uint allowed = clamps ? solve_tries : solve_direct_tries;
  uint left = push.tries;
  uint tries = 0u;
  bool fresh = true;
  float damping = 0.0;
  float missed = 0.0;
  float worst = 0.0;
  float level = 0.0;
  for (uint turn = 0u; turn < 4096u; ++turn) {
    hear(places, bound);
    // All threads reckon the same.
    float loud = 0.0;
    for (uint j = 0u; j < count; ++j) loud += length(field[j]);
    const float level_then = asked > 0.0 ? loud / asked : 0.0;
    float missed_then = 0.0;
    float worst_then = 0.0;
    for (uint j = 0u; j < count; ++j) {
      const float wants = wanted[j] * level_then;
      const float lacks = wants > 0.0 ? 1.0 - length(field[j]) / wants : 0.0;
      missed_then += lacks * lacks;
      worst_then = max(worst_then, abs(lacks));
    }
    const bool better = fresh || missed_then < missed;
    if (better) {
      damping = fresh ? solve_damping : max(damping * solve_less, solve_least_damping);
      if (fresh) tries = 0u;
      fresh = false;
      missed = missed_then;
      worst = worst_then;
      level = level_then;
      if (thread < count) {
        factor[thread] = tried[thread];
        heard[thread] = field[thread];
        const float wants = wanted[thread] * level;
        miss[thread] = wants > 0.0 ? 1.0 - length(field[thread]) / wants : 0.0;
      }
    } else {
      damping *= solve_more;
    }
    barrier();
    if (worst > solve_bounded_miss && tries < min(allowed, left) && damping <= solve_most_damping) {
      if (better) find_slopes(places, bound, level);
      step_even(damping);
      ++tries;
      continue;
    }
    left -= min(tries, left);
    if (clamps || (stage == 0u && worst <= solve_bounded_miss) || stage > solve_bounds) break;
    ++stage;
    bound = stage > solve_bounds ? 0.0 : stage == 1u ? solve_first_bound : bound * solve_next_bound;
    allowed = stage > solve_bounds ? solve_tries : solve_bound_tries;
    fresh = true;
    if (thread < count) tried[thread] = factor[thread];
    barrier();
  }
  if (thread < count) weights[slot.first + thread].zw = factor[thread];
}
