// Slots of several foci: each workgroup sums one slot's foci at every transducer, finds the largest sum and scales by
// it. With DRIVE_WEIGHTED defined, it computes the slots whose foci have complex factors; without, the others.
#include "shaders/array/drive/drive.h"
#include "shaders/array/drive/drive_inputs.glsl"
#include "shaders/array/drive/drive_phase.glsl"
#include "shaders/shared/turns.glsl"

layout(std430, set = 0, binding = 3) buffer Drives { DriveOut drives[]; };
#ifdef DRIVE_WEIGHTED
layout(set = 0, binding = 4) uniform samplerBuffer weights;
#endif
layout(push_constant) uniform Push { DrivePush push; };

shared float largest[drive_group];

bool sums(DriveSlot slot) {
#ifdef DRIVE_WEIGHTED
  return slot.count > 1u && slot.solved != drive_unsolved;
#else
  return slot.count > 1u && slot.solved == drive_unsolved;
#endif
}

// The amplitude for a sum of this size, relative to the common scale.
float amplitude_of(float size, float scale) { return size > 0.0 ? (scale > 0.0 ? min(size / scale, 1.0) : 1.0) : 0.0; }

// Writes the drives of a slot. Under `normalise`, the scale comes last, so the amplitudes hold the sizes until the same
// thread rescales them. Returns the largest of the thread's sums, over both the sums with every focus in full and those
// with gains.
float sum_foci(uint base, DriveSlot slot) {
  const bool even = push.weighting != drive_by_distance;
  float most = 0.0;
  for (uint begin = gl_LocalInvocationIndex; begin < push.transducers; begin += drive_group * drive_sum_each) {
    DrivePoint points[drive_sum_each];
    vec2 plain[drive_sum_each];  // every focus in full
    vec2 heard[drive_sum_each];  // each by its relative gain
    for (uint k = 0u; k < drive_sum_each; ++k) {
      points[k] = transducer_at(min(begin + k * drive_group, push.transducers - 1u));
      plain[k] = heard[k] = vec2(0.0);
    }
    for (uint j = 0u; j < slot.count; ++j) {
      const DriveFocus focus = focus_at(slot.first + j);
#ifdef DRIVE_WEIGHTED
      const vec4 weight = texelFetch(weights, int(slot.first + j));
#endif
      for (uint k = 0u; k < drive_sum_each; ++k) {
        const Path p = path(points[k].coarse, points[k].fine, focus.coarse, focus.fine);
        const float amplitude = even || focus.coarse.w == 0.0 ? 1.0 : min(p.distance * focus.coarse.w, 1.0);
        const vec2 asked = unit_of_part(p.turns) * amplitude;
#ifdef DRIVE_WEIGHTED
        plain[k] += times(weight.xy, asked);
        heard[k] += times(weight.zw, asked);
#else
        plain[k] += asked;
        heard[k] += asked * focus.fine.w;
#endif
      }
    }
    for (uint k = 0u; k < drive_sum_each; ++k) {
      const uint t = begin + k * drive_group;
      if (t >= push.transducers) continue;
      const float size = length(heard[k]);
      most = max(most, max(length(plain[k]), size));
#ifdef DRIVE_WEIGHTED
      if (push.constraint != drive_normalise && slot.count <= push.turned_foci)
        heard[k] = times(heard[k], unit_of_turns(drives[base + t].phase));
#endif
      const float phase = size > 0.0 ? clamp(atan(heard[k].y, heard[k].x), -float_pi, float_pi) : 0.0;
      const float amplitude = push.constraint == drive_normalise ? size
                              : push.constraint == drive_uniform ? slot.gain
                                                                 : amplitude_of(size, 1.0) * slot.gain;
      drives[base + t] = DriveOut(amplitude, phase);
    }
  }
  return most;
}

// The largest value of all threads.
float largest_of(float most) {
  const uint thread = gl_LocalInvocationIndex;
  largest[thread] = most;
  barrier();
  for (uint left = drive_group / 2u; left > 0u; left >>= 1u) {
    if (thread < left) largest[thread] = max(largest[thread], largest[thread + left]);
    barrier();
  }
  return largest[0];
}

void drive_slot(uint s) {
  const DriveSlot slot = slot_at(s);
  if (!sums(slot)) return;
  const uint base = s * push.transducers;
  const float most = sum_foci(base, slot);
  if (push.constraint != drive_normalise) return;
  const float scale = largest_of(most);
  for (uint t = gl_LocalInvocationIndex; t < push.transducers; t += drive_group)
    drives[base + t].amplitude = amplitude_of(drives[base + t].amplitude, scale) * slot.gain;
}
