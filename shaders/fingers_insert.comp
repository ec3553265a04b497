#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Every contact's block and cell: finds the block in the hash table and puts the contact into its cell's list. The first to
// come owns the block; who that is, and the lists' order, may differ from run to run: nothing that leaves the pass depends on it.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_contacts) uniform usamplerBuffer contacts;
layout(set = 0, binding = fingers_solids) uniform samplerBuffer solids;
layout(std430, set = 0, binding = fingers_nodes) writeonly buffer Nodes { uvec4 nodes[]; };
layout(std430, set = 0, binding = fingers_keys) writeonly buffer Keys { BlockKey keys[]; };
layout(std430, set = 0, binding = fingers_places) writeonly buffer Places { uint places[]; };
layout(std430, set = 0, binding = fingers_slots) coherent buffer Slots { uint slots[]; };
layout(std430, set = 0, binding = fingers_heads) buffer Heads { uint heads[]; };
layout(push_constant) uniform Push { FingersPush push; };

struct Place {
  uvec3 point;  // bits
  BlockKey block;
  uint cell;
};

// An owner's place, too, is computed: its key may not have been written yet.
Place place_of(uint contact) {
  const uvec3 bits = texelFetch(contacts, int(2u * contact)).xyz;
  const uint solid = texelFetch(contacts, int(2u * contact + 1u)).x;
  const vec3 centre = texelFetch(solids, int(solid * fingers_solid_texels + fingers_centre_texel)).xyz;
  const ivec3 cell = ivec3(floor((uintBitsToFloat(bits) - centre) * push.cells_per_metre));
  const uvec3 block = uvec3((cell >> 1) + 32768) & 0xffffu;
  const uvec3 half_of_block = uvec3(cell) & 1u;
  return Place(bits, BlockKey(block.x | block.y << 16u, block.z | solid << 16u),
               half_of_block.x | half_of_block.y << 1u | half_of_block.z << 2u);
}

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint mask = table_slots(count) - 1u;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const Place mine = place_of(i);
    const uint hash = block_hash(mine.block);
    const uint word = i | (hash & ~owner_bits);
    uint owner = i;
    bool claimed = false;
    for (uint probe = 0u; probe <= mask; ++probe) {  // at least half the slots stay free
      const uint slot = table_slot(hash, probe) & mask;
      uint there = slots[slot];
      if (there == fingers_nothing) {
        there = atomicCompSwap(slots[slot], fingers_nothing, word);
        claimed = there == fingers_nothing;
        if (claimed) break;
      }
      owner = there & owner_bits;
      if (may_be(there, hash) && place_of(owner).block == mine.block) break;
    }
    if (claimed) owner = i;
    const uint place = owner * fingers_block_cells + mine.cell;
    keys[i] = mine.block;
    places[i] = place;
    nodes[i] = uvec4(mine.point, atomicExchange(heads[place], i));
  }
}
