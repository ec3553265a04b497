// Shared by engine/touch/sections/sections_pass.cpp and shaders/sections_*.comp.
#ifndef PALPA_SHADERS_SECTIONS_H
#define PALPA_SHADERS_SECTIONS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// Contacts are put in order of their fingers by counting: they are cut into chunks, a group each, and a chunk into as
// many runs as the group has threads; runs count, then each knows where its own contacts go. A pass over contacts has
// more groups than that (at most contacts_most_groups): only one in sections_groups_per_chunk is needed, every so
// many-th, since a software device gives each core groups that follow each other.
PALPA_CONST sections_groups_per_chunk = 4u;
PALPA_CONST sections_most_chunks = 32u;
PALPA_CONST sections_chunk_group = 32u;
// One group per finger in sections_axes; its contact k is thread k mod sections_group's.
PALPA_CONST sections_group = 128u;
// A hash table of the fingers' roots, twice as long as there can be fingers.
PALPA_CONST sections_table = 128u;

// What the buffers hold, beside structs. What two of the shaders only read they read as texels of four words.
//   parents  uint[]: per contact a number that its finger alone has
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
