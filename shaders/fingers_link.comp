#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"
#include "fingers_math.h"

// Unites groups of cells of blocks that touch where they hold two contacts within the gap: one thread per block and
// neighbour (or itself), all blocks' nearest neighbours first. Two groups that show no such pair soon go to fingers_crowded;
// with `all` they do not: that is for when its list was too short.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool all = false;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_nodes) readonly buffer Nodes { uvec4 nodes[]; };
layout(std430, set = 0, binding = fingers_keys) readonly buffer Keys { BlockKey keys[]; };
layout(std430, set = 0, binding = fingers_slots) readonly buffer Slots { uint slots[]; };
layout(std430, set = 0, binding = fingers_heads) readonly buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = fingers_list) readonly buffer List { uint list[]; };
layout(std430, set = 0, binding = fingers_crowded) writeonly buffer Crowded { CrowdedPair crowded[]; };
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_parents) coherent buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_groups) readonly buffer Groups { uint groups_of_block[]; };
layout(push_constant) uniform Push { FingersPush push; };

uint most_steps = 0u;
#include "fingers_cells.glsl"
#include "fingers_pairs.glsl"
#include "fingers_union.glsl"

// The neighbours (x, y, z) + 1, base 3: the block itself, sides, edges, corners.
const uint neighbours[fingers_neighbours] =
    uint[fingers_neighbours](13u, 14u, 16u, 22u, 15u, 17u, 19u, 21u, 23u, 25u, 18u, 20u, 24u, 26u);

// For each of them the pairs of cells at most two apart, as pairs_of has them, cells counted from the sides that face each
// other.
const uvec2 reachable[fingers_neighbours] = uvec2[fingers_neighbours](
    uvec2(0xffffffffu, 0xffffffffu), uvec2(0x55ff55ffu, 0x55ff55ffu), uvec2(0x3333ffffu, 0x3333ffffu),
    uvec2(0xffffffffu, 0x0f0f0f0fu), uvec2(0x113355ffu, 0x113355ffu), uvec2(0x113355ffu, 0x113355ffu),
    uvec2(0x3333ffffu, 0x03030f0fu), uvec2(0x55ff55ffu, 0x050f050fu), uvec2(0x55ff55ffu, 0x050f050fu),
    uvec2(0x3333ffffu, 0x03030f0fu), uvec2(0x113355ffu, 0x0103050fu), uvec2(0x113355ffu, 0x0103050fu),
    uvec2(0x113355ffu, 0x0103050fu), uvec2(0x113355ffu, 0x0103050fu));

void defer(CrowdedPair pair) {
  const uint place = atomicAdd(work.crowded, 1u);
  if (place < push.most_contacts / fingers_contacts_per_crowded) {
    crowded[place] = pair;
    atomicMax(work.crowded_x, min(place / blocks_group + 1u, blocks_most_groups));
  } else {
    atomicMax(work.rest_x, blocks_most_groups);
  }
}

void main() {
  const uint units = work.blocks * fingers_neighbours;
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  const uint contacts = min(found.total, push.most_contacts);
  const uint mask = table_slots(contacts) - 1u;
  most_steps = contacts;
  for (uint unit = gl_GlobalInvocationID.x; unit < units; unit += threads) {
    const uint neighbour = unit / work.blocks;
    const uint here = list[unit % work.blocks];
    const BlockKey key = keys[here];
    const uint code = neighbours[neighbour];
    const uvec3 block = uvec3(key.xy & 0xffffu, key.xy >> 16u, key.z_solid & 0xffffu) +
                        uvec3(code % 3u, code / 3u % 3u, code / 9u) - 1u;
    const BlockKey wanted = BlockKey(block.x | block.y << 16u, block.z | (key.z_solid & 0xffff0000u));
    uint slot = block_hash(wanted) & mask;
    uint there = slots[slot];
    for (uint probe = 0u; probe <= mask && there != fingers_nothing; ++probe) {
      if (keys[there] == wanted) break;
      slot = (slot + 1u) & mask;
      there = slots[slot];
    }
    if (there == fingers_nothing) continue;

    const uint groups_here = groups_of_block[here];
    const uint groups_there = groups_of_block[there];
    uvec2 todo = pairs_of(first_cells(groups_here), first_cells(groups_there));  // mostly one pair of groups
    if (there == here) todo &= each_pair_once;
    // Cells that face each other first: they are the likeliest to be within the gap.
    const uint face_here = (code % 3u == 2u ? 1u : 0u) | (code / 3u % 3u == 2u ? 2u : 0u) | (code / 9u == 2u ? 4u : 0u);
    const uint face_there = (code % 3u == 0u ? 1u : 0u) | (code / 3u % 3u == 0u ? 2u : 0u);
    for (uint k = 0u; k < 64u && (todo.x | todo.y) != 0u; ++k) {
      const uint pair = take_pair(todo);
      const uint a = heads[here * fingers_block_cells + (pair >> 3u)];
      const uint b = heads[there * fingers_block_cells + (pair & 7u)];
      if (find_root(a) == find_root(b)) continue;
      const uint cells_a = cells_of_group(groups_here, pair >> 3u);
      const uint cells_b = cells_of_group(groups_there, pair & 7u);
      Search search = Search(pairs_of(flipped(cells_a, face_here), flipped(cells_b, face_there)) & reachable[neighbour],
                             here * fingers_block_cells | face_here, there * fingers_block_cells | face_there, false, true);
      go_on(search, all ? 0xffffffffu : fingers_patience);
      if (search.open) defer(CrowdedPair(here, there, cells_a, cells_b));
      if (search.found) unite(a, b);
    }
  }
}
