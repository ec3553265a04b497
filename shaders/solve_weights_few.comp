#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "solve_inputs.glsl"
#include "solve_rules.glsl"

// The factors of each slot's foci from its matrix, where they are few: a slot is one thread's work, its matrix in
// registers.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = solve_matrices) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = drive_weights) writeonly buffer Weights { vec4 weights[]; };

void main() {
  const uint s = gl_GlobalInvocationID.x;
  if (s >= push.slots) return;
  const DriveSlot slot = slot_at(s);
  if (!solves(slot)) return;
  const uint count = slot.count;

  // Beyond `count` all is 0: such a focus gives nothing, asks for nothing and hears nothing.
  vec2 matrix[most * most];  // [column * most + row]
  [[unroll]] for (uint c = 0u; c < most; ++c) {
    [[unroll]] for (uint r = 0u; r < most; ++r) {
      const vec2 entry = matrices[slot.solved + min(c, count - 1u) * count + min(r, count - 1u)];
      matrix[c * most + r] = c < count && r < count ? entry : vec2(0.0);
    }
  }
  float loudest = 0.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) loudest = max(loudest, matrix[j * most + j].x);

  // As if each sounded alone; phases from the way to the first transducer.
  const Source first = source_of(0u);
  vec2 factor[most];
  float wanted[most];
  float gains[most];
  float share[most];
  float shares = 0.0;
  bool differ = false;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const float own = max(matrix[j * most + j].x, 0.0);
    wanted[j] = j < count ? claim_of(own, loudest) : 0.0;
    gains[j] = gain_of(slot.first + min(j, count - 1u));
    differ = differ || gains[j] != 1.0;
    share[j] = own > 0.0 ? wanted[j] / own : 0.0;
    shares += share[j];
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const float size = shares > 0.0 ? min(share[j] * float(count) / shares, push.most_weight) : 1.0;
    const vec2 unit = pair_of(first, place_of(slot.first + min(j, count - 1u))).unit;
    factor[j] = j < count ? size * vec2(unit.x, -unit.y) : vec2(0.0);
  }

  // First all alike, at the level that they have then; from there, where gains differ, once more with the level kept.
  vec2 plain[most];
  [[unroll]] for (uint j = 0u; j < most; ++j) plain[j] = factor[j];
  bool alike = true;
  bool still = false;
  float level = 0.0;
  uint left = push.steps;
  for (uint i = 0u; i <= 2u * push.steps + 1u; ++i) {
    vec2 field[most];
    float size[most];
    float heard = 0.0;
    float asked = 0.0;
    [[unroll]] for (uint r = 0u; r < most; ++r) {
      vec2 sum = vec2(0.0);
      [[unroll]] for (uint c = 0u; c < most; ++c) sum += times(matrix[c * most + r], factor[c]);
      field[r] = sum;
      size[r] = length(sum);
      heard += size[r];
      asked += wanted[r];
    }
    if (alike) level = asked > 0.0 ? heard / asked : 0.0;
    if (still || left == 0u) {
      if (!alike) break;
      [[unroll]] for (uint j = 0u; j < most; ++j) plain[j] = factor[j];
      if (!differ) break;
      alike = still = false;
      left = push.steps;
      [[unroll]] for (uint j = 0u; j < most; ++j) {
        factor[j] *= gains[j];
        wanted[j] *= gains[j];
      }
      continue;
    }
    float total = 0.0;
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const float grown = length(factor[j]) * growth(wanted[j] * level, size[j]);
      total += grown;
      size[j] = grown;
    }
    const float scale = alike && total > 0.0 ? float(count) / total : 1.0;
    float farthest = 0.0;
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const vec2 next = turned(min(size[j] * scale, push.most_weight), field[j], factor[j]);
      farthest = max(farthest, length(next - factor[j]));
      factor[j] = next;
    }
    still = farthest < push.still;
    --left;
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    if (j < count) weights[slot.first + j] = vec4(plain[j], factor[j]);
  }
}
