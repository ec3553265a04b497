#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_math.h"
#include "fingers_table.glsl"
#include "scan.h"

// Unites groups of cells of blocks that touch where they hold two contacts within the gap: one thread per pair of blocks on
// the list. Groups of two blocks that a few tests leave apart go to fingers_crowded. With `all` every block's every neighbour is
// looked at, for when one of the lists was too short, and what many tests leave apart goes to fingers_undecided.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool all = false;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_nodes) uniform usamplerBuffer nodes;
layout(set = 0, binding = fingers_tiles) uniform usamplerBuffer tiles;
layout(set = 0, binding = fingers_bases) uniform usamplerBuffer bases;
layout(set = 0, binding = fingers_list) uniform usamplerBuffer list;
layout(std430, set = 0, binding = fingers_crowded) writeonly buffer Left { uvec4 left[]; };  // CrowdedPair
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_forest) buffer Forest { uint forest[]; };
layout(set = 0, binding = fingers_seen) uniform usamplerBuffer seen;
layout(set = 0, binding = fingers_groups) uniform usamplerBuffer groups_of_block;
layout(set = 0, binding = fingers_links) uniform usamplerBuffer links;
layout(push_constant) uniform Push { FingersPush push; };

#include "fingers_cells.glsl"
#include "fingers_neighbours.glsl"
#include "fingers_pairs.glsl"
#include "fingers_undecided.glsl"
#include "fingers_union.glsl"

// By the axes along which two blocks lie apart, as bits x, y, z: the pairs of cells at most two apart, as pairs_of has them,
// cells counted from the sides that face each other.
const uvec2 reachable[8] =
    uvec2[8](uvec2(0xffffffffu, 0xffffffffu), uvec2(0x55ff55ffu, 0x55ff55ffu), uvec2(0x3333ffffu, 0x3333ffffu),
             uvec2(0x113355ffu, 0x113355ffu), uvec2(0xffffffffu, 0x0f0f0f0fu), uvec2(0x55ff55ffu, 0x050f050fu),
             uvec2(0x3333ffffu, 0x03030f0fu), uvec2(0x113355ffu, 0x0103050fu));

// A pair for the pass that decides: its four words as one vector, a software device then finds its place only once.
void defer(uvec4 pair) {
  if (all) {
    const uint place = atomicAdd(work.undecided, 1u);
    if (place >= undecided_room(push.most_contacts)) return;
    left[place] = pair;
    atomicMax(work.undecided_x, undecided_groups(place));
  } else {
    const uint place = atomicAdd(work.crowded, 1u);
    if (place >= push.most_contacts * fingers_crowded_per_contact) return;
    left[place] = pair;
    if (place % blocks_group == 0u) atomicMax(work.crowded_x, place / blocks_group + 1u);
  }
}

bool links_ran_out() { return work.links > push.most_contacts * fingers_links_per_contact; }

// How many pairs of blocks there are to look at. A list that ran out has holes, and the last pass looks at everything.
uint units_of(uint blocks) {
  if (all) return blocks * 64u;
  return links_ran_out() ? 0u : work.links;
}

void main() {
  const uint blocks = work.blocks;
  const uint units = units_of(blocks);
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  const uint slots = table_slots(min(found.total, push.most_contacts));
  if (!all && gl_GlobalInvocationID.x == 0u && links_ran_out()) work.rest_x = min(blocks, rest_most_groups);
  for (uint unit = gl_GlobalInvocationID.x; unit < units; unit += threads) {
    const uint link = all ? unit : texelFetch(links, int(unit)).x;
    const uint entry = texelFetch(list, int(link >> 6u)).x;
    const uint beyond = link >> 3u & 7u;
    const uint corner_here = entry & 7u;
    const uint corner_there = link & 7u;
    if (all && (corners_to_see(corner_here, beyond) >> corner_there & 1u) == 0u) continue;
    const uint slot_here = entry >> 3u;
    const uvec4 tile = texelFetch(tiles, int(slot_here));
    const Tile other = tile_beyond(TileKey(tile.x, tile.y), corner_here, beyond, slots);
    const Block here = block_of(texelFetch(bases, int(slot_here)).x, tile.zw, corner_here);
    const Block there = block_of(texelFetch(bases, int(other.slot)).x, other.cells, corner_there);
    if (there.occupied == 0u) continue;
    const bool itself = here.first == there.first;

    const uint groups_here = texelFetch(groups_of_block, int(here.first)).x;
    const uint groups_there = texelFetch(groups_of_block, int(there.first)).x;
    // Cells that face each other first: they are the likeliest to be within the gap.
    const uint axes = corner_here ^ corner_there;
    const uint face_here = axes & ~(corner_here ^ beyond);
    const uint face_there = axes ^ face_here;
    const uvec2 pairs_in_reach =
        pairs_of(flipped(here.occupied, face_here), flipped(there.occupied, face_there)) & reachable[axes];
    uvec2 apart = pairs_of(first_cells(groups_here), first_cells(groups_there));  // groups; mostly one pair
    if (itself) apart &= each_pair_once;
    Search search = search_in(itself ? pairs_in_reach & each_pair_once : pairs_in_reach);
    if (all) {  // patience is long: spare it what is together already
      uvec2 todo = apart;
      for (uint k = 0u; k < 64u && (todo.x | todo.y) != 0u; ++k) {
        const uint pair = take_pair(todo);
        if (seen_root(cell_number(here, pair >> 3u)) != seen_root(cell_number(there, pair & 7u))) continue;
        leave(search, pairs_of(flipped(cells_of_group(groups_here, pair >> 3u), face_here),
                               flipped(cells_of_group(groups_there, pair & 7u), face_there)));
      }
    }
    uvec2 together = uvec2(0u);
    for (uint k = 0u; k < (all ? fingers_rest_patience : fingers_patience) && more(search); ++k) {
      if (!test(search, here, there, face_here, face_there)) continue;
      const uint a = group_of(groups_here, face_here ^ (search.pair >> 3u));
      const uint b = group_of(groups_there, face_there ^ (search.pair & 7u));
      const uint cells_a = cells_of_group(groups_here, a);
      const uint cells_b = cells_of_group(groups_there, b);
      together |= pairs_of(1u << a, 1u << b);
      leave(search, pairs_of(flipped(cells_a, face_here), flipped(cells_b, face_there)));
      if (itself) leave(search, pairs_of(cells_a | cells_b, cells_a | cells_b));
    }
    apart &= more(search) ? ~together : uvec2(0u);
    for (uint k = 0u; k < 64u && (together.x | together.y) != 0u; ++k) {
      const uint pair = take_pair(together);
      unite(cell_number(here, pair >> 3u), cell_number(there, pair & 7u));
    }
    for (uint k = 0u; k < 64u && (apart.x | apart.y) != 0u; ++k) {
      const uint pair = take_pair(apart);
      defer(uvec4(here.first, there.first, here.occupied | cells_of_group(groups_here, pair >> 3u) << 8u,
                  there.occupied | cells_of_group(groups_there, pair & 7u) << 8u));
    }
  }
}
