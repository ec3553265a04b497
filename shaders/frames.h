// Shared by engine/touch/frames.cpp and shaders/frames_*.comp.
#ifndef PALPA_SHADERS_FRAMES_H
#define PALPA_SHADERS_FRAMES_H
#include "shared.h"
PALPA_SHADER_BEGIN

// Contacts are put in order of their fingers by counting: they are cut into chunks, a group each, and a chunk into as
// many runs as the group has threads; runs count, then each knows where its own contacts go. A pass over contacts has
// more groups than that (at most contacts_most_groups): only one in frames_groups_per_chunk is needed.
PALPA_CONST frames_groups_per_chunk = 4u;
PALPA_CONST frames_most_chunks = 32u;
PALPA_CONST frames_chunk_group = 32u;
// One group per finger in frames_axes; its contact k is thread k mod frames_group's.
PALPA_CONST frames_group = 128u;
// A hash table of the fingers' roots, twice as long as there can be fingers.
PALPA_CONST frames_table = 128u;

// Bindings of all three shaders.
PALPA_CONST frames_total = 0u;     // ScanTotal of the contacts
PALPA_CONST frames_parents = 1u;   // uint[]: per contact a number that its finger alone has
PALPA_CONST frames_contacts = 2u;  // ContactRecord[]: `finger` is written
PALPA_CONST frames_header = 3u;    // TouchHeader
PALPA_CONST frames_counts = 4u;    // uint[frames_most_chunks * fingers_most]: contacts of a finger in a chunk
PALPA_CONST frames_grouped = 5u;   // uvec4[]: bits of x, y, z and the contact's number, finger after finger
PALPA_CONST frames_fingers = 6u;   // FingerRecord[]
PALPA_CONST frames_buffers = 7u;

#ifndef __cplusplus
uint chunks_of(uint groups) {
  return (groups + frames_groups_per_chunk - 1u) / frames_groups_per_chunk;
}
#endif

struct FramesPush {
  uint most_contacts;
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(FramesPush, 16);

PALPA_SHADER_END
#endif
