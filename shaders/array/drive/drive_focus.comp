#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/array/drive/drive.h"
#include "shaders/array/drive/drive_inputs.glsl"
#include "shaders/array/drive/drive_phase.glsl"

// Slots of one focus, and silent slots. No trigonometry: the phase comes straight from the wrapped turns.
layout(local_size_x = 32) in;

// DriveOut[], each written as one vector: a software device then computes the address and the active lanes only once.
layout(std430, set = 0, binding = 3) writeonly buffer Drives { vec2 drives[]; };
layout(push_constant) uniform Push { DrivePush push; };

void main() {
  const uint begin = gl_WorkGroupID.x * (drive_group * drive_each) + gl_LocalInvocationIndex;
  DrivePoint points[drive_each];
  for (uint k = 0u; k < drive_each; ++k) points[k] = transducer_at(min(begin + k * drive_group, push.transducers - 1u));
  const uint first = gl_WorkGroupID.y * drive_slots_per_group;
  const uint last = min(first + drive_slots_per_group, push.slots);
  for (uint s = first; s < last; ++s) {
    const DriveSlot slot = slot_at(s);
    if (slot.count > 1u) continue;
    const bool sounds = slot.count == 1u;
    // A silent slot has no focus; any entry will do, and the buffer has at least one.
    const DriveFocus focus = focus_at(sounds ? slot.first : 0u);
    const bool even = push.weighting != drive_by_distance || focus.coarse.w == 0.0;
    const uint base = s * push.transducers;
    for (uint k = 0u; k < drive_each; ++k) {
      const uint t = begin + k * drive_group;
      const Path p = path(points[k].coarse, points[k].fine, focus.coarse, focus.fine);
      const float amplitude = (even ? 1.0 : min(p.distance * focus.coarse.w, 1.0)) * slot.gain;
      if (t < push.transducers) drives[base + t] = sounds ? vec2(amplitude, phase_of(p.turns)) : vec2(0.0, 0.0);
    }
  }
}
