#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Finds every contact's block in the hash table and puts the contact into its cell's list. The first to come owns the block;
// who that is, and the lists' order, may differ from run to run: nothing that leaves the pass depends on it.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_nodes) writeonly buffer Nodes { uvec4 nodes[]; };
layout(std430, set = 0, binding = fingers_keys) readonly buffer Keys { BlockKey keys[]; };
layout(std430, set = 0, binding = fingers_places) buffer Places { uint places[]; };
layout(std430, set = 0, binding = fingers_slots) coherent buffer Slots { uint slots[]; };
layout(std430, set = 0, binding = fingers_heads) buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = fingers_list) writeonly buffer List { uint list[]; };
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(push_constant) uniform Push { FingersPush push; };

// Room for the block with this number in the dispatches over blocks and links; each block asks for its own group.
void ask_for_groups(uint block) {
  if (block % blocks_group == 0u) atomicMax(work.blocks_x, min(block / blocks_group + 1u, blocks_most_groups));
  if (block % 4u == 0u) {
    const uint groups = ((block + 4u) * fingers_neighbours + blocks_group - 1u) / blocks_group;
    atomicMax(work.links_x, min(groups, blocks_most_groups));
  }
}

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint mask = table_slots(count) - 1u;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const BlockKey key = keys[i];
    uint slot = block_hash(key) & mask;
    uint owner = i;
    bool claimed = false;
    for (uint probe = 0u; probe <= mask; ++probe) {  // at least half the slots stay free
      owner = slots[slot];
      if (owner == fingers_nothing) {
        owner = atomicCompSwap(slots[slot], fingers_nothing, i);
        claimed = owner == fingers_nothing;
      }
      if (claimed) owner = i;
      if (claimed || keys[owner] == key) break;
      slot = (slot + 1u) & mask;
    }
    if (claimed) {
      const uint block = atomicAdd(work.blocks, 1u);
      list[block] = i;
      ask_for_groups(block);
    }
    const uint place = owner * fingers_block_cells + places[i];
    places[i] = place;
    nodes[i].w = atomicExchange(heads[place], i);
  }
}
