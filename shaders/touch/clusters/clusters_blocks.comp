#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/touch/clusters/clusters_table.glsl"
#include "shaders/shared/scan.h"

// Groups the cells of each block with each other, as far as a few tests show: one thread per block. Most blocks become
// one group. The rest is listed for clusters_link: the block's neighbours, and the block itself if tests remain.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer nodes;
layout(set = 0, binding = 2) uniform usamplerBuffer tiles;
layout(set = 0, binding = 3) uniform usamplerBuffer bases;
layout(set = 0, binding = 4) uniform usamplerBuffer list;
layout(std430, set = 0, binding = 5) writeonly buffer Links { uvec2 links[]; };
layout(std430, set = 0, binding = 6) writeonly buffer GroupsOfBlock { uint groups_of_block[]; };
layout(std430, set = 0, binding = 7) buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 8) writeonly buffer Forest { uint forest[]; };
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"
#include "shaders/touch/clusters/clusters_links.glsl"
#include "shaders/touch/clusters/clusters_neighbours.glsl"
#include "shaders/touch/clusters/clusters_pairs.glsl"

const uint patience = 32u;

// The blocks that a block sees, as bits: those of its own tile, and a byte for each tile beyond, with the slots of
// these tiles.
struct Near {
  uint here;
  uint beyond;
  uvec4 slots;
};

Near near_to(uvec4 tile, uint corner, bool itself, uint slots) {
  const uint after = ~bits_below(corner) & occupied_blocks(tile.zw);
  Near near = Near(itself ? after : after & ~(1u << corner), 0u, uvec4(0u));
  uint to_see = tiles_to_see(corner);
  uint k = 0u;
  for (;;) {
    if (to_see != 0u) {
      const uint beyond = uint(findLSB(to_see));
      to_see &= to_see - 1u;
      const Tile other = tile_beyond(TileKey(tile.x, tile.y), corner, beyond, slots);
      near.beyond |= (corners_beyond(corner, beyond) & occupied_blocks(other.cells)) << 8u * k;
      near.slots[k++] = other.slot;
    }
    if (to_see == 0u) break;
  }
  return near;
}

// A place on the list for this many links, or clusters_nothing.
uint place_for(uint count) {
  if (count == 0u) return clusters_nothing;
  const uint place = atomicAdd(work.links, count);
  if (place + count > links_room(push.most_contacts)) return clusters_nothing;
  const uint groups = (place + count + blocks_group - 1u) / blocks_group;
  if (groups != (place + blocks_group - 1u) / blocks_group) atomicMax(work.links_x, min(groups, blocks_most_groups));
  return place;
}

// Lists a block with these blocks of one tile.
void list_links(inout uint place, uint first_here, uint corner, uint beyond, uint corners, uint tile_first, uvec2 cells) {
  for (;;) {
    if (corners != 0u) {
      const uint there = uint(findLSB(corners));
      corners &= corners - 1u;
      links[place++] = link_of(first_here, block_of(tile_first, cells, there).first, corner, beyond, there);
    }
    if (corners == 0u) break;
  }
}

void list_all(Near near, uint first_here, uint corner, uint tile_first, uvec2 cells) {
  uint place = place_for(uint(bitCount(near.here) + bitCount(near.beyond)));
  if (place == clusters_nothing) return;
  list_links(place, first_here, corner, 0u, near.here, tile_first, cells);
  uint to_see = tiles_to_see(corner);
  uint k = 0u;
  for (;;) {
    if (near.beyond != 0u) {
      const uint beyond = uint(findLSB(to_see));
      const int slot = int(near.slots[k++]);
      list_links(place, first_here, corner, beyond, near.beyond & 0xffu, texelFetch(bases, slot).x, texelFetch(tiles, slot).zw);
      to_see &= to_see - 1u;
      near.beyond >>= 8u;
    }
    if (near.beyond == 0u) break;
  }
}

void main() {
  const uint blocks = work.blocks;
  const uint slots = table_slots(min(found.total, push.most_contacts));
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  for (uint i = gl_GlobalInvocationID.x; i < blocks; i += threads) {
    const uint entry = texelFetch(list, int(i)).x;
    const uint corner = entry & 7u;
    const uvec4 tile = texelFetch(tiles, int(entry >> 3u));
    const uint tile_first = texelFetch(bases, int(entry >> 3u)).x;
    const Block block = block_of(tile_first, tile.zw, corner);
    uint groups = each_by_itself(block.occupied);
    Search search = search_in(pairs_of(block.occupied, block.occupied) & each_pair_once);
    uint left = more(search) ? patience : 0u;
    for (;;) {
      if (left != 0u) {
        if (test(search, block, block, 0u, 0u)) {
          const uint a = group_of(groups, search.pair >> 3u);
          const uint b = group_of(groups, search.pair & 7u);
          groups = merged(groups, a, b);
          const uint cells = cells_of_group(groups, min(a, b));
          leave(search, pairs_of(cells, cells));
        }
        left = more(search) ? left - 1u : 0u;
      }
      if (left == 0u) break;
    }
    groups_of_block[block.first] = groups;
    uint cells = block.occupied;
    uint cell = block.first;
    for (;;) {
      if (cells != 0u) {
        forest[cell++] = cell_number(block, group_of(groups, uint(findLSB(cells))));
        cells &= cells - 1u;
      }
      if (cells == 0u) break;
    }
    list_all(near_to(tile, corner, more(search), slots), block.first, corner, tile_first, tile.zw);
  }
}
