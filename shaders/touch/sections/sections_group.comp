#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/sections/sections.h"
#include "shaders/shared/scan.h"

// Sorts the contacts by finger; within a finger, they keep their order. Runs are the same as in sections_count.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer contacts;  // ContactRecord, in halves
layout(std430, set = 0, binding = 2) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 3) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 4) writeonly buffer Grouped { uvec4 grouped[]; };
layout(std430, set = 0, binding = 5) buffer Fingers { FingerRecord fingers[]; };
layout(push_constant) uniform Push { SectionsPush push; };

shared uint sums[fingers_most];
shared uint places[fingers_most * sections_chunk_group];

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(found.total, push.most_contacts);
  const uint known = min(header.fingers, fingers_most);
  const uint chunks = chunks_of(gl_NumWorkGroups.x);
  if (gl_WorkGroupID.x % sections_groups_per_chunk != 0u) return;  // the whole group
  const uint chunk = gl_WorkGroupID.x / sections_groups_per_chunk;
  const uint runs = chunks * sections_chunk_group;
  const uint run = (count + runs - 1u) / runs;
  const uint first = min((chunk * sections_chunk_group + thread) * run, count);
  const uint last = min(first + run, count);

  for (uint f = 0u; f < known; ++f) places[f * sections_chunk_group + thread] = 0u;
  for (uint i = first; i < last; ++i) {
    const uint finger = texelFetch(contacts, int(2u * i + 1u)).z;
    if (finger != no_finger) ++places[finger * sections_chunk_group + thread];
  }
  for (uint f = thread; f < known; f += sections_chunk_group) {
    uint sum = 0u;
    for (uint c = 0u; c < chunks; ++c) sum += counts[c * fingers_most + f];
    sums[f] = sum;
  }
  barrier();
  for (uint f = thread; f < known; f += sections_chunk_group) {
    uint place = 0u;
    for (uint g = 0u; g < f; ++g) place += sums[g];
    if (chunk == 0u) fingers[f].start = place;
    for (uint c = 0u; c < chunk; ++c) place += counts[c * fingers_most + f];
    for (uint t = 0u; t < sections_chunk_group; ++t) {
      const uint own = places[f * sections_chunk_group + t];
      places[f * sections_chunk_group + t] = place;
      place += own;
    }
  }
  barrier();
  for (uint i = first; i < last; ++i) {
    const uvec4 rest = texelFetch(contacts, int(2u * i + 1u));  // solid, depth, finger
    const uint finger = rest.z;
    if (finger == no_finger) continue;
    const uvec4 half_record = texelFetch(contacts, int(2u * i));
    const uint place = places[finger * sections_chunk_group + thread]++;
    grouped[place] = uvec4(half_record.xyz, rest.y);
  }
}
