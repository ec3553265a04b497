#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/follow/follow.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// One finger per group: what the next frame has to know of it.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 4) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 5) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 7) readonly buffer Tracks { TrackTable tracks; };
layout(std430, set = 0, binding = 8) writeonly buffer Known { KnownTable known; };
layout(std430, set = 0, binding = 9) readonly buffer Claims { Claim claims[]; };
layout(push_constant) uniform Push { KnownPush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  pick_samples(parents[fingers[finger].first], min(found.total, push.most_contacts));
  if (thread < count_taken) {
    const Float3 inside = inside_of(positions[thread], normals[thread], push.finger_width);
    known.insides[finger * known_samples + thread] = vec4(inside.x, inside.y, inside.z, 0.0);
  }
  if (thread == 0u) {
    known.fingers[finger] =
        KnownFinger(fingers[finger].solid, fingers[finger].contacts, count_taken, claims[finger].parting_us,
                    tracks.tracks[finger].velocity, claims[finger].meeting_us, 0u, 0u, 0u);
  }
}
