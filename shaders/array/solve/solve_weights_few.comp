#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/array/solve/solve_inputs.glsl"

// The factors of each slot's foci from its matrix, for slots of few foci: one thread computes a slot, with the matrix
// in registers. A single loop computes the sound of the tried factors and then does whatever comes next, so the largest
// part of the code exists only once.
layout(local_size_x = 8) in;

layout(std430, set = 0, binding = 5) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = 6) writeonly buffer Weights { vec4 weights[]; };

#include "shaders/array/solve/solve_rules.glsl"
#include "shaders/array/solve/solve_near.glsl"

// All entries beyond the slot's count are 0: such a focus gives nothing, asks for nothing and hears nothing.
vec2 matrix[most * most];  // [column * most + row]
vec2 tried[most];          // factors
vec2 field[most];          // their sound at the foci
vec2 factor[most];         // the best factors so far
vec2 heard[most];          // their sound at the foci
float wanted[most];        // t_j
float miss[most];

void hear() {
  [[unroll]] for (uint r = 0u; r < most; ++r) {
    vec2 sum = vec2(0.0);
    [[unroll]] for (uint c = 0u; c < most; ++c) sum += times(matrix[c * most + r], tried[c]);
    field[r] = sum;
  }
}

float level_now() {
  float loud = 0.0;
  float asked = 0.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    loud += length(field[j]);
    asked += wanted[j];
  }
  return asked > 0.0 ? loud / asked : 0.0;
}

// One step of gs_pat.hpp; all magnitudes add up to `sum`. Returns the largest distance that a factor moved.
float climb(float sum) {
  float moved = 0.0;
  const float level = level_now();
  float size[most];
  float total = 0.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    size[j] = length(tried[j]) * growth(wanted[j] * level, length(field[j]));
    total += size[j];
  }
  const float scale = total > 0.0 ? sum / total : 1.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const vec2 next = turned(min(size[j] * scale, push.most_weight), field[j], tried[j]);
    moved = max(moved, length(next - tried[j]));
    tried[j] = next;
  }
  return moved;
}

// The damped step of even_out.hpp from `factor` to `tried`. Few of a slot's steps are of this kind. Only the innermost
// loops are unrolled: with all loops unrolled, a software device would compile for seconds. With none, it would end the
// shader, whose loops may take 65,535 iterations in all.
void step_even(float level, float damping) {
  const uint count = focus_count;
  vec2 turn[most];
  float normal[most * most];
  float rest[most];
  [[unroll]] for (uint a = 0u; a < most; ++a) {
    const float loud = length(heard[a]);
    const float asked = wanted[a] * level;
    turn[a] = loud > 0.0 && asked > 0.0 ? vec2(heard[a].x, -heard[a].y) / (loud * asked) : vec2(0.0);
    rest[a] = miss[a];
    [[unroll]] for (uint b = 0u; b < most; ++b) normal[a * most + b] = 0.0;
  }
  float trace = 0.0;
  for (uint a = 0u; a < count; ++a) {
    for (uint b = 0u; b <= a; ++b) {
      // The real part of the sum over q of J_aq and the conjugate of J_bq; each row turns as a whole.
      vec2 sum = vec2(0.0);
      [[unroll]] for (uint q = 0u; q < most; ++q) {
        const vec2 x = matrix[q * most + a];
        const vec2 y = matrix[q * most + b];
        sum += vec2(x.x * y.x + x.y * y.y, x.y * y.x - x.x * y.y);
      }
      const vec2 by = times(turn[a], vec2(turn[b].x, -turn[b].y));
      const float entry = by.x * sum.x - by.y * sum.y;
      normal[a * most + b] = entry;
      normal[b * most + a] = entry;
      if (a == b) trace += entry;
    }
  }
  // A direction without any slope is left as it is.
  const float more = max(damping * trace / float(count), 1e-30);
  for (uint a = 0u; a < count; ++a) normal[a * most + a] += more;
  for (uint k = 0u; k < count; ++k) {
    const float inverse = 1.0 / normal[k * most + k];
    for (uint i = k + 1u; i < count; ++i) {
      const float part = normal[i * most + k] * inverse;
      // The rest of column k is not read again.
      [[unroll]] for (uint j = 0u; j < most; ++j) normal[i * most + j] -= part * normal[k * most + j];
      rest[i] -= part * rest[k];
    }
  }
  for (uint left = count; left > 0u; --left) {
    const uint k = left - 1u;
    float sum = rest[k];
    [[unroll]] for (uint j = 1u; j < most; ++j) sum -= j > k ? normal[k * most + j] * rest[j] : 0.0;
    rest[k] = sum / normal[k * most + k];
  }
  for (uint q = 0u; q < count; ++q) {
    vec2 sum = factor[q];
    [[unroll]] for (uint a = 0u; a < most; ++a) {
      const vec2 slope = times(turn[a], matrix[q * most + a]);
      sum += vec2(slope.x, -slope.y) * rest[a];
    }
    tried[q] = sum;
  }
}

// The power that the factors take from the array.
float power() {
  float sum = 0.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) sum += dot(factor[j], heard[j]);
  return sum;
}

// The loudness of the weakest focus relative to the power that the factors take.
float merit() {
  float least = -1.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const float loud = wanted[j] > 0.0 ? length(heard[j]) / wanted[j] : least;
    if (wanted[j] > 0.0) least = least < 0.0 ? loud : min(least, loud);
  }
  const float takes = power();
  return takes > 0.0 && least > 0.0 ? least * inversesqrt(takes) : 0.0;
}

void main() {
  const uint s = gl_GlobalInvocationID.x;
  if (s >= push.slots) return;
  const DriveSlot slot = slot_at(s);
  if (!solves(slot)) return;
  focus_base = slot.solved;
  focus_first = slot.first;
  focus_count = slot.count;
  const uint count = slot.count;

  [[unroll]] for (uint c = 0u; c < most; ++c) {
    [[unroll]] for (uint r = 0u; r < most; ++r) {
      const vec2 entry = matrices[slot.solved + min(c, count - 1u) * count + min(r, count - 1u)];
      matrix[c * most + r] = c < count && r < count ? entry : vec2(0.0);
    }
  }
  float share[most];
  float shares = 0.0;
  bool differ = false;
  const float loudest = loudest_alone();
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const float own = max(matrix[j * most + j].x, 0.0);
    wanted[j] = j < count ? claim_of(own, loudest) : 0.0;
    differ = differ || gain_of(slot.first + min(j, count - 1u)) != 1.0;
    share[j] = own > 0.0 ? wanted[j] / own : 0.0;
    shares += share[j];
  }
  [[unroll]] for (uint j = 0u; j < most; ++j)
    share[j] = j >= count ? 0.0 : shares > 0.0 ? min(share[j] * float(count) / shares, push.most_weight) : 1.0;

  const uint starts = hear_each_other() ? solve_starts : 1u;
  uint begun = 0u;     // starts so far
  bool begins = true;  // the next start begins
  bool plainly = false;  // all starts are judged; the best one is now completed
  bool again = false;    // the same with gains
  uint climbs = 0u;
  uint tries = 0u;
  uint allowed = 0u;
  bool fresh = true;
  float kept = 0.0;  // the level; 0: not fixed
  float level = 0.0;
  float damping = 0.0;
  float missed = 0.0;
  float worst = 0.0;
  float best_merit = -1.0;
  vec2 best[most];
  vec2 plain[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) best[j] = plain[j] = vec2(0.0);

  for (uint turn = 0u; turn < 4096u; ++turn) {
    if (begins) {
      [[unroll]] for (uint j = 0u; j < most; ++j) tried[j] = vec2(0.0);
      const uint sounds = begun == 0u ? 1u : solve_sounds;
      for (uint i = 0u; i < sounds; ++i) {
        const Source source = source_of((begun * solve_sounds + i) * push.stride % push.transducers);
        [[unroll]] for (uint j = 0u; j < most; ++j) {
          const vec2 unit = pair_of(source, place_of(slot.first + min(j, count - 1u))).unit;
          tried[j] += vec2(unit.x, -unit.y);
        }
      }
      [[unroll]] for (uint j = 0u; j < most; ++j) tried[j] = turned(share[j], tried[j], vec2(1.0, 0.0));
      begins = false;
      climbs = starts > 1u ? solve_climb : push.steps;
      allowed = starts > 1u ? solve_look : 0u;
      fresh = true;
    }
    // A separate loop: a software device executes the whole body of a loop in each of its iterations.
    for (;;) {
      hear();
      if (climbs == 0u) break;
      climbs = climb(float(count)) < push.still ? 0u : climbs - 1u;
    }
    const float level_then = kept > 0.0 ? kept : level_now();
    float missed_then = 0.0;
    float worst_then = 0.0;
    float miss_then[most];
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const float asked = wanted[j] * level_then;
      miss_then[j] = asked > 0.0 ? 1.0 - length(field[j]) / asked : 0.0;
      missed_then += miss_then[j] * miss_then[j];
      worst_then = max(worst_then, abs(miss_then[j]));
    }
    if (fresh || missed_then < missed) {
      damping = fresh ? solve_damping : max(damping * solve_less, solve_least_damping);
      if (fresh) tries = 0u;
      fresh = false;
      missed = missed_then;
      worst = worst_then;
      level = level_then;
      [[unroll]] for (uint j = 0u; j < most; ++j) {
        factor[j] = tried[j];
        heard[j] = field[j];
        miss[j] = miss_then[j];
      }
    } else {
      damping *= solve_more;
    }
    if (worst > solve_miss && tries < allowed && damping <= solve_most_damping) {
      step_even(level, damping);
      ++tries;
      continue;
    }
    // The allowed steps are used up.
    fresh = true;
    allowed = push.constraint == drive_normalise ? solve_tries : solve_bounded_tries;
    if (!plainly) {
      const float good = merit();
      if (begun == 0u || good > best_merit * solve_better) {
        best_merit = good;
        [[unroll]] for (uint j = 0u; j < most; ++j) best[j] = factor[j];
      }
      ++begun;
      begins = begun < starts;
      plainly = !begins;
      [[unroll]] for (uint j = 0u; j < most; ++j) tried[j] = best[j];
      continue;
    }
    if (again) break;
    [[unroll]] for (uint j = 0u; j < most; ++j) plain[j] = factor[j];
    if (!differ) break;
    again = true;
    kept = level;
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      tried[j] = factor[j] * gain_of(slot.first + min(j, count - 1u));
      wanted[j] = j < count ? target_of(j, loudest) : 0.0;
    }
  }

  float scale = 1.0;
  if (push.constraint == drive_clamp) {
    const float takes = power();
    float alone_in_all = 0.0;
    float gains = 0.0;
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      alone_in_all += matrix[j * most + j].x / float(count);
      const float gain = gain_of(slot.first + min(j, count - 1u));
      gains += j < count ? gain * gain : 0.0;
    }
    if (takes > 0.0 && alone_in_all > 0.0) scale = solve_fill * sqrt(gains * alone_in_all / takes);
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    if (j < count) weights[slot.first + j] = vec4(plain[j], factor[j] * scale);
  }
}
