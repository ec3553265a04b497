#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_math.h"
#include "fingers_table.glsl"
#include "scan.h"

// Groups the cells of each block among themselves as far as a few tests show: one thread per block. Most blocks become one
// group. Then lists what is left to fingers_link: the block's neighbours, and the block itself where tests are left.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_nodes) uniform usamplerBuffer nodes;
layout(set = 0, binding = fingers_tiles) uniform usamplerBuffer tiles;
layout(set = 0, binding = fingers_bases) uniform usamplerBuffer bases;
layout(set = 0, binding = fingers_list) uniform usamplerBuffer list;
layout(std430, set = 0, binding = fingers_links) writeonly buffer Links { uint links[]; };
layout(std430, set = 0, binding = fingers_groups) writeonly buffer Groups { uint groups_of_block[]; };
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_forest) writeonly buffer Forest { uint forest[]; };
layout(push_constant) uniform Push { FingersPush push; };

#include "fingers_cells.glsl"
#include "fingers_neighbours.glsl"
#include "fingers_pairs.glsl"

const uint patience = 32u;

// Puts a block's neighbours, given as bits, on the list.
void list_links(uint block, uvec2 near) {
  const uint count = uint(bitCount(near.x) + bitCount(near.y));
  if (count == 0u) return;
  const uint place = atomicAdd(work.links, count);
  if (place + count > push.most_contacts * fingers_links_per_contact) return;
  const uint groups = (place + count + blocks_group - 1u) / blocks_group;
  if (groups != (place + blocks_group - 1u) / blocks_group) atomicMax(work.links_x, min(groups, blocks_most_groups));
  for (uint n = 0u; n < count; ++n) links[place + n] = block << 6u | take_pair(near);
}

void main() {
  const uint blocks = work.blocks;
  const uint slots = table_slots(min(found.total, push.most_contacts));
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  for (uint i = gl_GlobalInvocationID.x; i < blocks; i += threads) {
    const uint entry = texelFetch(list, int(i)).x;
    const uint corner = entry & 7u;
    const uvec4 tile = texelFetch(tiles, int(entry >> 3u));
    const Block block = block_of(texelFetch(bases, int(entry >> 3u)).x, tile.zw, corner);
    uint groups = each_by_itself(block.occupied);
    Search search = search_in(pairs_of(block.occupied, block.occupied) & each_pair_once);
    for (uint k = 0u; k < patience && more(search); ++k) {
      if (!test(search, block, block, 0u, 0u)) continue;
      const uint a = group_of(groups, search.pair >> 3u);
      const uint b = group_of(groups, search.pair & 7u);
      groups = merged(groups, a, b);
      const uint cells = cells_of_group(groups, min(a, b));
      leave(search, pairs_of(cells, cells));
    }
    groups_of_block[block.first] = groups;
    uint cells = block.occupied;
    for (uint k = 0u; k < 8u && cells != 0u; ++k) {
      forest[block.first + k] = cell_number(block, group_of(groups, uint(findLSB(cells))));
      cells &= cells - 1u;
    }

    const uint after = ~bits_below(corner) & occupied_blocks(tile.zw);
    uvec2 near = uvec2(more(search) ? after : after & ~(1u << corner), 0u);
    uint to_see = tiles_to_see(corner);
    for (uint k = 0u; k < 4u && to_see != 0u; ++k) {
      const uint beyond = uint(findLSB(to_see));
      to_see &= to_see - 1u;
      const Tile other = tile_beyond(TileKey(tile.x, tile.y), corner, beyond, slots);
      const uint corners = corners_beyond(corner, beyond) & occupied_blocks(other.cells);
      if (beyond < 4u) {
        near.x |= corners << 8u * beyond;
      } else {
        near.y |= corners << 8u * (beyond & 3u);
      }
    }
    list_links(i, near);
  }
}
