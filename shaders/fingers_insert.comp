#version 460
#extension GL_GOOGLE_include_directive : require
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Puts every contact into its cell: finds or claims the cell's slot and joins its list. Lists and ranks come in any order;
// nothing that leaves the pass depends on it.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_nodes) writeonly buffer Nodes { Node nodes[]; };
layout(std430, set = 0, binding = fingers_cells) readonly buffer Cells { CellKey cells[]; };
layout(std430, set = 0, binding = fingers_parents) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_places) writeonly buffer Places { Place places[]; };
layout(std430, set = 0, binding = fingers_slots) coherent buffer Slots { Slot slots[]; };
layout(push_constant) uniform Push { FingersPush push; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const uint count = min(found.total, push.most_contacts);
  if (i >= count) return;

  const CellKey key = cells[i];
  const uint mask = table_slots(count) - 1u;
  uint slot = cell_hash(ivec3(key.x, key.y, key.z), key.solid) & mask;
  for (uint probe = 0u; probe <= mask; ++probe) {  // at least half the slots stay free
    uint owner = slots[slot].owner;
    if (owner == fingers_nothing) owner = atomicCompSwap(slots[slot].owner, fingers_nothing, i);
    if (owner == fingers_nothing || owner == i || cells[owner] == key) break;
    slot = (slot + 1u) & mask;
  }
  if (slots[slot].first > i) atomicMin(slots[slot].first, i);
  places[i] = Place(slot, atomicAdd(slots[slot].count, 1u));
  nodes[i].next = atomicExchange(slots[slot].head, i);
}
