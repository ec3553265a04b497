#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"

// Gives the contacts of joined patches one number: that of the finger's first patch, whose own contacts keep theirs.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { BridgePush push; };

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uint root = parents[i];
    const uint now = parents[clusters[root].smallest];
    if (now != root) parents[i] = now;
  }
}
