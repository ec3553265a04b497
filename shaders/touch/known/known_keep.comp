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
layout(std430, set = 0, binding = 3) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 4) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 5) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 7) readonly buffer Tracks { TrackTable tracks; };
layout(std430, set = 0, binding = 8) buffer Known { KnownTable known; };
layout(std430, set = 0, binding = 9) readonly buffer Claims { Claim claims[]; };
layout(push_constant) uniform Push { KnownPush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"

shared uint beyond;

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint root = parents[fingers[finger].first];
  const uint count = min(found.total, push.most_contacts);
  if (thread == 0u) beyond = 0u;
  pick_samples(root, count);
  if (known.reached != 0u) {
    for (uint i = thread; i < count; i += known_samples) {
      if (parents[i] == root && contacts[i].beyond != 0u) atomicAdd(beyond, 1u);
    }
  }
  barrier();
  if (thread < count_taken) {
    const Float3 inside = inside_of(positions[thread], normals[thread], push.finger_width);
    known.insides[finger * known_samples + thread] = vec4(inside.x, inside.y, inside.z, 0.0);
  }
  if (thread == 0u && count_taken == 0u) {  // its place instead
    const uint first = fingers[finger].first;
    known.insides[finger * known_samples] = vec4(contacts[first].x, contacts[first].y, contacts[first].z, 0.0);
  }
  if (thread == 0u) {
    const uint inside_shell = fingers[finger].contacts - beyond;
    fingers[finger].beyond = beyond;
    Fall fall = next_fall(claims[finger].fall, inside_shell);
    if ((push.rules & known_falling) == 0u) fall = Fall(inside_shell, 0u, 0u);
    fingers[finger].holds = (push.rules & known_few) != 0u && fall.falls == 0u ? 1u : 0u;
    KnownFinger kept = KnownFinger(fingers[finger].solid, max(count_taken, 1u), 0u, claims[finger].parting_us,
                                   tracks.tracks[finger].velocity, claims[finger].meeting_us, fall, vec4(0.0), vec4(0.0));
    if ((push.rules & known_edges) != 0u && fall.falls == 0u && starves(inside_shell, push.min_points) && count_taken > 0u) {
      Float3 place = Float3(0.0, 0.0, 0.0), normal = place;
      for (uint s = 0u; s < count_taken; ++s) {
        place = plus(place, minus(positions[s], positions[0]));
        normal = plus(normal, normals[s]);
      }
      const Float3 centre = plus(positions[0], scaled(place, 1.0 / float(count_taken)));
      float farthest = 0.0;
      for (uint s = 0u; s < count_taken; ++s) {
        const float square = square_apart(positions[s], centre);
        farthest = square > farthest ? square : farthest;
      }
      if (dot3(normal, normal) > 0.0) {
        const Float3 inward = unit(normal);
        kept.centre = vec4(centre.x, centre.y, centre.z, squared_reach(root_of(farthest, 1.0)));
        kept.inward = vec4(inward.x, inward.y, inward.z, 0.0);
        atomicAdd(known.reaching, 1u);
      }
    }
    known.fingers[finger] = kept;
  }
}
