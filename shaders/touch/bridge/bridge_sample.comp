#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/bridge/bridge_math.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// One finger per group: picks some of its contacts by a hash of their numbers, with the skin's normal there from the
// depth picture.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 4) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 5) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 7) writeonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 8) writeonly buffer Patches { BridgePatch patches[]; };
layout(std430, set = 0, binding = 9) readonly buffer Known { KnownTable known; };
layout(push_constant) uniform Push { BridgePush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"
#include "shaders/touch/known/known_label.glsl"

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint count = min(found.total, push.most_contacts);
  const uint root = parents[fingers[finger].first];
  pick_samples(root, count);
  uint label = known_none;
  if (thread < count_taken) {
    const Float3 position = positions[thread];
    const Float3 normal = normals[thread];
    samples[finger * bridge_samples + thread] =
        BridgeSample(position.x, position.y, position.z, normal.x, normal.y, normal.z, known_none, 0u);
    if ((push.rules & known_together) != 0u) label = known_label(fingers[finger].solid, position, normal);
  }
  const uint majority = known_majority(label, count_taken);
  if (thread == 0u && count_taken == 0u) patches[finger] = BridgePatch(vec4(0.0), vec4(0.0), vec4(0.0), 0u, known_none, 0u, 0u);
  if (thread == 0u && count_taken != 0u) {
    Float3 low = positions[0], high = low, sum = Float3(0.0, 0.0, 0.0);
    for (uint s = 0u; s < count_taken; ++s) {
      const Float3 p = positions[s];
      low = Float3(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z));
      high = Float3(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z));
      sum = plus(sum, minus(p, positions[0]));
    }
    const Float3 mean = plus(positions[0], scaled(sum, 1.0 / float(count_taken)));
    patches[finger] = BridgePatch(vec4(low.x, low.y, low.z, 0.0), vec4(high.x, high.y, high.z, 0.0),
                                  vec4(mean.x, mean.y, mean.z, 0.0), count_taken, majority, 0u, 0u);
  }
}
