#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/touch/clusters/clusters_table.glsl"
#include "shaders/shared/scan.h"

// Unites groups of cells of blocks that touch if they hold two contacts within the gap: one thread per pair of blocks
// on the list. Groups of two blocks that a few tests leave apart go to clusters_crowded. With `all`, every neighbour of
// every block is looked at: this is for the case that one of the lists was too short. Groups that many tests leave
// apart then go to clusters_undecided.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool all = false;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer nodes;
layout(set = 0, binding = 2) uniform usamplerBuffer tiles;
layout(set = 0, binding = 3) uniform usamplerBuffer bases;
layout(set = 0, binding = 4) uniform usamplerBuffer list;
layout(std430, set = 0, binding = 5) writeonly buffer Left { uvec4 left[]; };  // CrowdedPair
layout(std430, set = 0, binding = 6) buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 7) buffer Forest { uint forest[]; };
layout(set = 0, binding = 8) uniform usamplerBuffer seen;
layout(set = 0, binding = 9) uniform usamplerBuffer groups_of_block;
layout(set = 0, binding = 10) uniform usamplerBuffer links;
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"
#include "shaders/touch/clusters/clusters_links.glsl"
#include "shaders/touch/clusters/clusters_neighbours.glsl"
#include "shaders/touch/clusters/clusters_pairs.glsl"
#include "shaders/touch/clusters/clusters_undecided.glsl"
#include "shaders/touch/clusters/clusters_union.glsl"

// For two blocks that lie apart along these axes, as bits x, y, z: the pairs of cells at most two apart, as from
// pairs_of. Cells are counted from the sides that face each other.
uvec2 reachable(uint axes) {
  const uint x = (axes & 1u) != 0u ? 0x55ff55ffu : 0xffffffffu;
  const uint y = (axes & 2u) != 0u ? 0x3333ffffu : 0xffffffffu;
  const uint z = (axes & 4u) != 0u ? 0x0f0f0f0fu : 0xffffffffu;
  return uvec2(x & y, x & y & z);
}

// A pair for the pass that decides: its four words are one vector, so a software device computes the address only once.
void defer(uvec4 pair) {
  if (all) {
    const uint place = atomicAdd(work.undecided, 1u);
    if (place >= undecided_room(push.most_contacts)) return;
    left[place] = pair;
    atomicMax(work.undecided_x, undecided_groups(place));
  } else {
    const uint place = atomicAdd(work.crowded, 1u);
    if (place >= push.most_contacts * clusters_crowded_per_contact) return;
    left[place] = pair;
    if (place % blocks_group == 0u) atomicMax(work.crowded_x, place / blocks_group + 1u);
  }
}

bool links_ran_out() { return work.links > links_room(push.most_contacts); }

// The number of pairs of blocks to look at. A list that overflowed has holes, and the last pass looks at everything.
uint units_of(uint blocks) {
  if (all) return blocks * 64u;
  return links_ran_out() ? 0u : work.links;
}

// One of all possible links: a block and one of its neighbours, if it sees that neighbour and the neighbour exists.
bool found_link(uint unit, uint slots, out uvec2 link) {
  link = uvec2(0u);
  const uint entry = texelFetch(list, int(unit >> 6u)).x;
  const uint beyond = unit >> 3u & 7u;
  const uint corner = entry & 7u;
  const uint there = unit & 7u;
  if ((corners_to_see(corner, beyond) >> there & 1u) == 0u) return false;
  const int slot = int(entry >> 3u);
  const uvec4 tile = texelFetch(tiles, slot);
  const Tile other = tile_beyond(TileKey(tile.x, tile.y), corner, beyond, slots);
  const Block seen_block = block_of(texelFetch(bases, int(other.slot)).x, other.cells, there);
  link = link_of(block_of(texelFetch(bases, slot).x, tile.zw, corner).first, seen_block.first, corner, beyond, there);
  return seen_block.occupied != 0u;
}

void main() {
  const uint blocks = work.blocks;
  const uint units = units_of(blocks);
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  const uint slots = table_slots(min(found.total, push.most_contacts));
  if (!all && gl_GlobalInvocationID.x == 0u && links_ran_out()) work.rest_x = min(blocks, rest_most_groups);
  for (uint unit = gl_GlobalInvocationID.x; unit < units; unit += threads) {
    uvec2 packed;
    if (all) {
      if (!found_link(unit, slots, packed)) continue;
    } else {
      packed = texelFetch(links, int(unit)).xy;
    }
    const Link link = link_from(packed);
    const bool itself = link.first_here == link.first_there;
    const uint groups_here = texelFetch(groups_of_block, int(link.first_here)).x;
    const uint groups_there = texelFetch(groups_of_block, int(link.first_there)).x;
    const Block here = Block(link.first_here, occupied_of(groups_here));
    const Block there = Block(link.first_there, occupied_of(groups_there));
    // Cells that face each other come first: they are the likeliest to be within the gap.
    const uint face_here = link.face_here;
    const uint face_there = link.axes ^ face_here;
    const uint facing_here = flipped(groups_here, face_here);
    const uint facing_there = flipped(groups_there, face_there);
    const uvec2 in_reach_of_each_other =
        pairs_of(occupied_of(facing_here), occupied_of(facing_there)) & reachable(link.axes);
    uvec2 apart = pairs_of(first_cells(groups_here), first_cells(groups_there));  // groups; mostly one pair
    if (itself) apart &= each_pair_once;
    Search search = search_in(itself ? in_reach_of_each_other & each_pair_once : in_reach_of_each_other);
    if (all) {  // this takes many tests: leave out the groups that are already together
      uvec2 todo = apart;
      for (uint k = 0u; k < 64u && (todo.x | todo.y) != 0u; ++k) {
        const uint pair = take_pair(todo);
        if (seen_root(cell_number(here, pair >> 3u)) != seen_root(cell_number(there, pair & 7u))) continue;
        leave(search, pairs_of(cells_of_group(facing_here, pair >> 3u), cells_of_group(facing_there, pair & 7u)));
      }
    }
    uvec2 together = uvec2(0u);
    uint left = more(search) ? (all ? clusters_rest_patience : clusters_patience) : 0u;
    // A software device runs a loop for several threads until all have left it. With the check in the middle, threads
    // that leave at different turns cost no turn in which none of them works.
    for (;;) {
      if (left != 0u) {
        if (test(search, here, there, face_here, face_there)) {
          const uint a = group_of(facing_here, search.pair >> 3u);
          const uint b = group_of(facing_there, search.pair & 7u);
          const uint cells_a = cells_of_group(facing_here, a);
          const uint cells_b = cells_of_group(facing_there, b);
          together |= pairs_of(1u << a, 1u << b);
          leave(search, pairs_of(cells_a, cells_b));
          if (itself) leave(search, pairs_of(cells_a | cells_b, cells_a | cells_b));
        }
        left = more(search) ? left - 1u : 0u;
      }
      if (left == 0u) break;
    }
    apart &= more(search) ? ~together : uvec2(0u);
    for (;;) {
      if ((together.x | together.y) != 0u) {
        const uint pair = take_pair(together);
        unite(cell_number(here, pair >> 3u), cell_number(there, pair & 7u));
      }
      if ((together.x | together.y) == 0u) break;
    }
    for (uint k = 0u; k < 64u && (apart.x | apart.y) != 0u; ++k) {
      const uint pair = take_pair(apart);
      defer(uvec4(here.first, there.first, here.occupied | cells_of_group(groups_here, pair >> 3u) << 8u,
                  there.occupied | cells_of_group(groups_there, pair & 7u) << 8u));
    }
  }
}
