// Slots of several foci: each workgroup sums one slot's foci at every transducer, finds the largest sum and scales by it.
// With DRIVE_WEIGHTED defined, those slots whose foci have complex factors; without, the others.
#include "drive.h"
#include "drive_phase.glsl"

layout(local_size_x = 32) in;

layout(std430, set = 0, binding = drive_transducers) readonly buffer Transducers { DrivePoint transducers[]; };
layout(std430, set = 0, binding = drive_foci) readonly buffer Foci { DriveFocus foci[]; };
layout(std430, set = 0, binding = drive_slots) readonly buffer Slots { DriveSlot slots[]; };
layout(std430, set = 0, binding = drive_drives) buffer Drives { DriveOut drives[]; };
#ifdef DRIVE_WEIGHTED
layout(std430, set = 0, binding = drive_weights) readonly buffer Weights { vec4 weights[]; };
#endif
layout(push_constant) uniform Push { DrivePush push; };

shared float largest[drive_group];

void main() {
  const DriveSlot slot = slots[gl_WorkGroupID.x];
#ifdef DRIVE_WEIGHTED
  if (slot.count < 2u || slot.solved == drive_unsolved) return;
#else
  if (slot.count < 2u || slot.solved != drive_unsolved) return;
#endif
  const uint base = gl_WorkGroupID.x * push.transducers;
  const uint thread = gl_LocalInvocationIndex;
  const bool even = push.weighting != drive_by_distance;

  float most = 0.0;
  for (uint begin = thread; begin < push.transducers; begin += drive_group * drive_sum_each) {
    vec4 coarse[drive_sum_each];
    vec4 fine[drive_sum_each];
    vec2 plain[drive_sum_each];  // every focus in full
    vec2 heard[drive_sum_each];  // each by its relative gain
    for (uint k = 0u; k < drive_sum_each; ++k) {
      const uint t = min(begin + k * drive_group, push.transducers - 1u);
      coarse[k] = transducers[t].coarse;
      fine[k] = transducers[t].fine;
      plain[k] = heard[k] = vec2(0.0);
    }
    for (uint j = 0u; j < slot.count; ++j) {
      const DriveFocus focus = foci[slot.first + j];
#ifdef DRIVE_WEIGHTED
      const vec4 weight = weights[slot.first + j];
#endif
      for (uint k = 0u; k < drive_sum_each; ++k) {
        const Path p = path(coarse[k], fine[k], focus.coarse, focus.fine);
        const float phase = phase_of(p.turns);
        const float amplitude = even || focus.coarse.w == 0.0 ? 1.0 : min(p.distance * focus.coarse.w, 1.0);
        const vec2 asked = vec2(cos(phase), sin(phase)) * amplitude;
#ifdef DRIVE_WEIGHTED
        plain[k] += vec2(weight.x * asked.x - weight.y * asked.y, weight.x * asked.y + weight.y * asked.x);
        heard[k] += vec2(weight.z * asked.x - weight.w * asked.y, weight.z * asked.y + weight.w * asked.x);
#else
        plain[k] += asked;
        heard[k] += asked * focus.fine.w;
#endif
      }
    }
    for (uint k = 0u; k < drive_sum_each; ++k) {
      const uint t = begin + k * drive_group;
      if (t >= push.transducers) continue;
      most = max(most, length(plain[k]));
      // The sum waits in the drive's own place; the same thread fetches it below.
      drives[base + t] = DriveOut(heard[k].x, heard[k].y);
    }
  }
  largest[thread] = most;
  barrier();
  for (uint left = drive_group / 2u; left > 0u; left >>= 1u) {
    if (thread < left) largest[thread] = max(largest[thread], largest[thread + left]);
    barrier();
  }
  const float scale = push.constraint == drive_normalise ? largest[0] : 1.0;

  for (uint t = thread; t < push.transducers; t += drive_group) {
    const vec2 sum = vec2(drives[base + t].amplitude, drives[base + t].phase);
    const float size = length(sum);
    DriveOut result = DriveOut(0.0, 0.0);
    if (size > 0.0) {
      result.amplitude = scale > 0.0 ? min(size / scale, 1.0) : 1.0;
      result.phase = clamp(atan(sum.y, sum.x), -float_pi, float_pi);
    }
    if (push.constraint == drive_uniform) result.amplitude = 1.0;
    result.amplitude *= slot.gain;
    drives[base + t] = result;
  }
}
