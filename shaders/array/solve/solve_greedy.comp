#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/array/solve/solve_inputs.glsl"

// greedy.hpp: each transducer's choice depends on all choices before it, so one thread computes a slot, and slots run
// side by side. All data of a focus stays in registers, so there are two kernels: for few foci and for many. A dispatch
// lets a range of the transducers choose. Between dispatches, a slot's state is kept in the weights of its foci. (A
// software driver ends a shader's loops after 65,535 iterations in all.)
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 5) buffer Weights { vec4 weights[]; };
layout(std430, set = 0, binding = 6) writeonly buffer Drives { DriveOut drives[]; };

const uint together = 4u;  // phases tried per iteration of the loop
const float float_pi = 3.1415925;

void main() {
  const uint s = gl_GlobalInvocationID.x;
  if (s >= push.slots) return;
  const DriveSlot slot = slot_at(s);
  if (!solves(slot)) return;
  const uint count = slot.count;

  Place places[most];
  float gains[most];
  vec2 field[most];  // the sound of all choices so far
  float size[most];  // its magnitude
  float level = 0.0;
  float squares = 0.0;
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const uint focus = slot.first + min(j, count - 1u);
    places[j] = place_of(focus);
    // An entry beyond the slot's foci asks for nothing and hears nothing.
    gains[j] = j < count ? gain_of(focus) : 0.0;
    squares += gains[j] * gains[j];
    const vec4 before = push.begin == 0u ? vec4(0.0) : weights[focus];
    field[j] = before.xy;
    size[j] = before.z;
    if (j == 0u) level = before.w;
  }
  const float share = squares > 0.0 ? 1.0 / sqrt(squares) : 0.0;

  uint n = push.next;
  for (uint turn = push.begin; turn < push.end; ++turn) {
    const Source source = source_of(n);
    vec2 gives[most];
    float energy[most];
    float lacks[most];
    float total = 0.0;
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      const Pair pair = pair_of(source, places[j]);
      const float loud = j < count ? pair.loud : 0.0;
      gives[j] = pair.unit * loud;
      energy[j] = loud * loud;
      total += energy[j];
    }
    level += sqrt(total / float(count));
    [[unroll]] for (uint j = 0u; j < most; ++j) lacks[j] = gains[j] * share * level - size[j];

    uint best = 0u;
    float least = 0.0;
    for (uint some = 0u; some < solve_phases; some += together) {
      [[unroll]] for (uint k = 0u; k < together; ++k) {
        const uint c = some + k;
        const vec2 by = unit_of_turns(float(c) / float(solve_phases));
        float cost = 0.0;
        [[unroll]] for (uint j = 0u; j < most; ++j) {
          const vec2 more = times(gives[j], by);
          const float both = length(field[j] + more) + size[j];
          const float gained = (2.0 * dot(field[j], more) + energy[j]) / max(both, 1e-30);
          cost += gained * (gained - 2.0 * lacks[j]);
        }
        // To the first transducer, all phases are equal.
        if (c == 0u || (turn != 0u && cost < least)) {
          least = cost;
          best = c;
        }
      }
    }
    const float turns = float(best) / float(solve_phases);
    const vec2 by = unit_of_turns(turns);
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      field[j] += times(gives[j], by);
      size[j] = length(field[j]);
    }
    const float phase = (turns > 0.5 ? turns - 1.0 : turns) * 6.2831853;
    drives[s * push.transducers + n] = DriveOut(slot.gain, min(phase, float_pi));
    n += push.stride;
    if (n >= push.transducers) n -= push.transducers;
  }
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    if (j < count) weights[slot.first + j] = vec4(field[j], size[j], level);
  }
}
