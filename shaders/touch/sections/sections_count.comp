#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/sections/sections.h"
#include "shaders/shared/scan.h"

// Each contact's finger, and the number of contacts of each finger in a chunk. Each thread walks a run of consecutive
// contacts.
layout(local_size_x = 32) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 4) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 5) readonly buffer Fingers { FingerRecord fingers[]; };
layout(push_constant) uniform Push { SectionsPush push; };

shared uint roots[sections_table];
shared uint owners[sections_table];
shared uint tally[fingers_most * sections_chunk_group];

uint place_of(uint root) {
  return (root * 2654435761u) >> 25u;
}

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

  for (uint k = thread; k < sections_table; k += sections_chunk_group) owners[k] = no_finger;
  for (uint f = 0u; f < known; ++f) tally[f * sections_chunk_group + thread] = 0u;
  barrier();
  if (thread == 0u) {  // fingers are few
    for (uint f = 0u; f < known; ++f) {
      const uint root = parents[fingers[f].first];
      uint place = place_of(root);
      for (uint step = 0u; step < sections_table && owners[place] != no_finger; ++step) place = (place + 1u) % sections_table;
      roots[place] = root;
      owners[place] = f;
    }
  }
  barrier();

  for (uint i = first; i < last; ++i) {
    const uint root = parents[i];
    uint place = place_of(root);
    // The table is never full, so an empty place ends every search.
    for (uint step = 0u; step < sections_table && owners[place] != no_finger && roots[place] != root; ++step) {
      place = (place + 1u) % sections_table;
    }
    const uint finger = owners[place];
    contacts[i].finger = finger;
    if (finger != no_finger) ++tally[finger * sections_chunk_group + thread];
  }
  barrier();

  for (uint f = thread; f < known; f += sections_chunk_group) {
    uint sum = 0u;
    for (uint t = 0u; t < sections_chunk_group; ++t) sum += tally[f * sections_chunk_group + t];
    counts[chunk * fingers_most + f] = sum;
  }
}
