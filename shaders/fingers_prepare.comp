#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Every contact's block and cell, an empty hash table and empty lists.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_contacts) readonly buffer Contacts { uvec4 contacts[]; };  // ContactRecord, in halves
layout(std430, set = 0, binding = fingers_solids) readonly buffer Solids { SolidRecord solids[]; };
layout(std430, set = 0, binding = fingers_nodes) writeonly buffer Nodes { uvec4 nodes[]; };
layout(std430, set = 0, binding = fingers_keys) writeonly buffer Keys { BlockKey keys[]; };
layout(std430, set = 0, binding = fingers_places) writeonly buffer Places { uint places[]; };
layout(std430, set = 0, binding = fingers_slots) writeonly buffer Slots { uint slots[]; };
layout(std430, set = 0, binding = fingers_heads) writeonly buffer Heads { uvec4 heads[]; };
layout(std430, set = 0, binding = fingers_work) writeonly buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_parents) writeonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_clusters) writeonly buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { FingersPush push; };

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint table = table_slots(count);
  if (gl_GlobalInvocationID.x == 0u) work = FingersWork(0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u);
  for (uint s = gl_GlobalInvocationID.x; s < table; s += threads) slots[s] = fingers_nothing;

  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uvec4 bits = contacts[2u * i];
    const vec3 point = uintBitsToFloat(bits.xyz);
    const uint solid = contacts[2u * i + 1u].x;
    const ivec3 cell = ivec3(floor((point - solids[solid].centre.xyz) * push.cells_per_metre));
    const uvec3 block = uvec3((cell >> 1) + 32768) & 0xffffu;
    const uvec3 half_of_block = uvec3(cell) & 1u;
    nodes[i] = uvec4(bits.xyz, fingers_nothing);
    keys[i] = BlockKey(block.x | block.y << 16u, block.z | solid << 16u);
    places[i] = half_of_block.x | half_of_block.y << 1u | half_of_block.z << 2u;
    heads[2u * i] = uvec4(fingers_nothing);
    heads[2u * i + 1u] = uvec4(fingers_nothing);
    parents[i] = i;
    clusters[i] = Cluster(fingers_nothing, 0u);
  }
}
