// Shared by engine/touch/sections/sections_pass.cpp and shaders/touch/sections/sections_*.comp.
#ifndef PALPA_SHADERS_SECTIONS_H
#define PALPA_SHADERS_SECTIONS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// Contacts are sorted by their fingers with a counting sort: they are cut into chunks, a group each, and a chunk into
// as many runs as the group has threads. Runs count, then each knows where its own contacts go. A pass over contacts
// has more groups than that (at most contacts_most_groups). Only one in sections_groups_per_chunk is needed. They are
// spread evenly, because a software device gives each core consecutive groups.
PALPA_CONST sections_groups_per_chunk = 4u;
PALPA_CONST sections_most_chunks = 32u;
PALPA_CONST sections_chunk_group = 32u;
// One group per finger in sections_axes; its contact k belongs to thread k mod sections_group.
PALPA_CONST sections_group = 128u;
// A hash table of the fingers' roots, twice as large as the greatest number of fingers.
PALPA_CONST sections_table = 128u;

// Contents of the buffers, beside structs. Two of the shaders read as texels of four words what they only read.
//   parents  uint[]: per contact a number unique to its finger
//   counts   uint[sections_most_chunks * fingers_most]: contacts of a finger in a chunk
//   grouped  uvec4[]: bits of x, y, z and depth, finger after finger

#ifndef __cplusplus
uint chunks_of(uint groups) {
  return (groups + sections_groups_per_chunk - 1u) / sections_groups_per_chunk;
}
#endif

struct SectionsPush {
  uint most_contacts;
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(SectionsPush, 16);

PALPA_SHADER_END
#endif
