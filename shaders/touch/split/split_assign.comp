#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known.h"

// Contacts of fingers that are split get the number of the part whose sample is nearest; if two are equally near, of
// the first. If known fingers stay apart, the insides of contact and sample are compared, which lie on the finger's axis.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 4) readonly buffer States { SplitState states[]; };
layout(std430, set = 0, binding = 5) readonly buffer Labels { uint labels[]; };
layout(std430, set = 0, binding = 6) buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 7) coherent buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = 8) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 9) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 10) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(push_constant) uniform Push { SplitPush push; };

#include "shaders/touch/bridge/bridge_pixel.glsl"

shared uint split[bridge_fingers];
shared uint splits;

void main() {
  const uint fingers_here = min(header.fingers, bridge_fingers);
  if (gl_LocalInvocationIndex == 0u) {
    uint k = 0u;
    for (uint f = 0u; f < fingers_here; ++f) {
      if (states[f].kind == split_several) split[k++] = f;
    }
    splits = k;
  }
  barrier();
  if (splits == 0u) return;  // the whole group
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uint root = parents[i];
    for (uint k = 0u; k < splits; ++k) {
      const uint finger = split[k];
      if (states[finger].root != root) continue;
      Float3 place = Float3(contacts[i].x, contacts[i].y, contacts[i].z);
      Float3 normal = Float3(0.0, 0.0, 0.0);
      if ((push.rules & known_apart) != 0u) normal = normal_at(contacts[i].point);
      const bool by_inside = dot3(normal, normal) > 0.0;
      if (by_inside) place = inside_of(place, normal, push.finger_width);
      uint nearest = 0u;
      float nearest_square = 3.0e38;
      for (uint s = 0u; s < states[finger].samples; ++s) {
        const BridgeSample there = samples[finger * bridge_samples + s];
        Float3 at = Float3(there.x, there.y, there.z);
        if (by_inside) at = inside_of(at, Float3(there.normal_x, there.normal_y, there.normal_z), push.finger_width);
        const float square = square_apart(place, at);
        if (square < nearest_square) {
          nearest_square = square;
          nearest = s;
        }
      }
      const uint number = push.most_contacts + finger * split_numbers + labels[finger * bridge_samples + nearest];
      parents[i] = number;
      atomicMin(clusters[number].smallest, i);
      atomicAdd(clusters[number].size, 1u);
      break;
    }
  }
}
