#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// One finger per group: which finger of the frame before it is, and which one it is beside.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 4) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 5) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 7) readonly buffer Known { KnownTable known; };
layout(std430, set = 0, binding = 8) writeonly buffer Claims { Claim claims[]; };
layout(push_constant) uniform Push { KnownPush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"
#include "shaders/touch/known/known_label.glsl"

shared uint near_finger[known_samples];
shared float near_square[known_samples];

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint solid = fingers[finger].solid;
  pick_samples(parents[fingers[finger].first], min(found.total, push.most_contacts));
  uint label = known_none;
  near_finger[thread] = known_none;
  near_square[thread] = 0.0;
  if (thread < count_taken) {
    label = known_label(solid, positions[thread], normals[thread]);
    const Float3 inside = inside_of(positions[thread], normals[thread], push.finger_width);
    const NearestKnown nearest = nearest_known(solid, inside, push.finger_width);
    near_finger[thread] = nearest.finger;
    near_square[thread] = nearest.square;
  }
  uint majority = known_majority(label, count_taken);
  if (count_taken == 0u) {  // the whole group
    const uint first = fingers[finger].first;
    majority = known_at(solid, Float3(contacts[first].x, contacts[first].y, contacts[first].z));
  }
  if (thread == 0u) {
    NearestKnown best = NearestKnown(known_none, 3.0e38);
    for (uint s = 0u; s < count_taken; ++s) {
      if (near_finger[s] != known_none && near_square[s] < best.square) best = NearestKnown(near_finger[s], near_square[s]);
    }
    claims[finger] = Claim(majority, best.finger, fingers[finger].contacts, known_never, 0u, count_taken, Fall(0u, 0u, 0u));
  }
}
