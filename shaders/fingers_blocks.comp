#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "scan.h"
#include "fingers_math.h"

// Groups the cells of each block among themselves as far as a few tests show: one thread per block. Most blocks become one
// group; groups that only look apart are fingers_link's.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_nodes) readonly buffer Nodes { uvec4 nodes[]; };
layout(std430, set = 0, binding = fingers_heads) readonly buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = fingers_list) readonly buffer List { uint list[]; };
layout(std430, set = 0, binding = fingers_work) readonly buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_parents) writeonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_groups) writeonly buffer Groups { uint groups_of_block[]; };
layout(push_constant) uniform Push { FingersPush push; };

#include "fingers_cells.glsl"
#include "fingers_pairs.glsl"

const uint patience = 16u;

uint merged(uint groups, uint one, uint other) {
  const uint low = min(one, other);
  const uint high = max(one, other);
  for (uint cell = 0u; cell < fingers_block_cells; ++cell) {
    if (group_of(groups, cell) == high) groups = with_group(groups, cell, low);
  }
  return groups;
}

void main() {
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  for (uint i = gl_GlobalInvocationID.x; i < work.blocks; i += threads) {
    const uint block = list[i];
    const uint first = block * fingers_block_cells;
    uint groups = 0u;
    for (uint cell = 0u; cell < fingers_block_cells; ++cell) {
      groups = with_group(groups, cell, heads[first + cell] == fingers_nothing ? no_group : cell);
    }
    const uint occupied = first_cells(groups);
    uvec2 todo = pairs_of(occupied, occupied) & each_pair_once;
    for (uint k = 0u; k < 28u && (todo.x | todo.y) != 0u; ++k) {
      const uint pair = take_pair(todo);
      const uint a = pair >> 3u;
      const uint b = pair & 7u;
      Search search = Search(pairs_of(1u << a, 1u << b), first, first, false, true);
      go_on(search, patience);
      if (search.found) {
        const uint group = min(group_of(groups, a), group_of(groups, b));
        groups = merged(groups, group_of(groups, a), group_of(groups, b));
        const uint cells = cells_of_group(groups, group);
        todo &= ~pairs_of(cells, cells);
      }
    }
    groups_of_block[block] = groups;
    for (uint cell = 0u; cell < fingers_block_cells; ++cell) {
      const uint group = group_of(groups, cell);
      if (group == no_group) continue;
      parents[heads[first + cell]] = heads[first + group];
    }
  }
}
