#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"
#include "fingers_math.h"

// Groups the cells of each block among themselves as far as a few tests show: one thread per block. Most blocks become one
// group. Then lists what is left to fingers_link: the neighbours that there may be, and the block itself where tests are left.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_nodes) uniform usamplerBuffer nodes;
layout(set = 0, binding = fingers_keys) uniform usamplerBuffer keys;
layout(set = 0, binding = fingers_slots) uniform usamplerBuffer slots;
layout(set = 0, binding = fingers_heads) uniform usamplerBuffer heads;
layout(set = 0, binding = fingers_list) uniform usamplerBuffer list;
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_parents) writeonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_groups) writeonly buffer Groups { uint groups_of_block[]; };
layout(std430, set = 0, binding = fingers_links) writeonly buffer Links { uint links[]; };
layout(push_constant) uniform Push { FingersPush push; };

#include "fingers_cells.glsl"
#include "fingers_neighbours.glsl"
#include "fingers_pairs.glsl"

const uint patience = 32u;

// Puts a block's neighbours, given as bits, on the list.
void list_links(uint block, uint near) {
  const uint count = uint(bitCount(near));
  const uint place = atomicAdd(work.links, count);
  if (place + count > push.most_contacts * fingers_links_per_contact) {
    atomicMax(work.rest_x, blocks_most_groups);
    return;
  }
  atomicMax(work.links_x, min((place + count + blocks_group - 1u) / blocks_group, blocks_most_groups));
  for (uint n = 0u; n < count; ++n) {
    links[place + n] = block << 4u | uint(findLSB(near));
    near &= near - 1u;
  }
}

void main() {
  const uint blocks = work.blocks;
  const uint mask = table_slots(min(found.total, push.most_contacts)) - 1u;
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  for (uint i = gl_GlobalInvocationID.x; i < blocks; i += threads) {
    const uint block = texelFetch(list, int(i)).x;
    const Heads first = heads_of(block);
    uint groups = 0u;
    for (uint cell = 0u; cell < fingers_block_cells; ++cell) {
      groups = with_group(groups, cell, head_of(first, cell) == fingers_nothing ? no_group : cell);
    }
    const uint occupied = first_cells(groups);
    Search search = search_in(pairs_of(occupied, occupied) & each_pair_once);
    for (uint k = 0u; k < patience && more(search); ++k) {
      if (!test(search, first, first, 0u, 0u)) continue;
      const uint a = group_of(groups, search.pair >> 3u);
      const uint b = group_of(groups, search.pair & 7u);
      groups = merged(groups, a, b);
      const uint cells = cells_of_group(groups, min(a, b));
      leave(search, pairs_of(cells, cells));
    }
    groups_of_block[block] = groups;
    uint joined = occupied & ~first_cells(groups);
    for (uint k = 0u; k < fingers_block_cells && joined != 0u; ++k) {
      const uint cell = uint(findLSB(joined));
      joined &= joined - 1u;
      parents[head_of(first, cell)] = head_of(first, group_of(groups, cell));
    }
    const BlockKey key = key_of(block);
    uint near = more(search) ? 1u : 0u;
    for (uint n = 1u; n < fingers_neighbours; ++n) {
      near |= (may_be_there(neighbour_of(key, neighbours[n]), mask) ? 1u : 0u) << n;
    }
    list_links(i, near);
  }
}
