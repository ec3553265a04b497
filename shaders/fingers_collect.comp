#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Lists the blocks that there are, those of a tile one after the other: what the passes over blocks look at then lies close
// together, in whatever order the contacts came.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_slots) uniform usamplerBuffer slots;
layout(std430, set = 0, binding = fingers_list) writeonly buffer List { uint list[]; };
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(push_constant) uniform Push { FingersPush push; };

const uint least_run = 32u;  // slots that a thread looks at

void main() {
  const uint table = table_slots(min(found.total, push.most_contacts));
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint run = max((table + threads - 1u) / threads, least_run);
  const uint first = min(gl_GlobalInvocationID.x * run, table);
  const uint last = min(first + run, table);
  uint count = 0u;
  for (uint s = first; s < last; ++s) count += texelFetch(slots, int(s)).x != fingers_nothing ? 1u : 0u;
  if (count == 0u) return;
  uint place = atomicAdd(work.blocks, count);
  atomicMax(work.blocks_x, min((place + count + blocks_group - 1u) / blocks_group, blocks_most_groups));
  for (uint s = first; s < last; ++s) {
    const uint word = texelFetch(slots, int(s)).x;
    if (word != fingers_nothing) list[place++] = word & owner_bits;
  }
}
