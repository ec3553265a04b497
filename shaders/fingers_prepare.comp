#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// An empty hash table, empty lists, every contact by itself.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_slots) writeonly buffer Slots { uint slots[]; };
layout(std430, set = 0, binding = fingers_heads) writeonly buffer Heads { uvec4 heads[]; };
layout(std430, set = 0, binding = fingers_parents) writeonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_clusters) writeonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = fingers_work) writeonly buffer Work { FingersWork work; };
layout(push_constant) uniform Push { FingersPush push; };

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint table = table_slots(count);
  if (gl_GlobalInvocationID.x == 0u) work = FingersWork(0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u);
  for (uint s = gl_GlobalInvocationID.x; s < table; s += threads) slots[s] = fingers_nothing;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    heads[2u * i] = uvec4(fingers_nothing);
    heads[2u * i + 1u] = uvec4(fingers_nothing);
    parents[i] = i;
    clusters[i] = Cluster(fingers_nothing, 0u);
  }
}
