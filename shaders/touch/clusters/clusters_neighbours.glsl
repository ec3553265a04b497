// Finds the blocks that touch a block. A block is one corner of its tile. It touches the tile's seven others, and along
// any of the three axes its blocks touch those of one tile beyond. A neighbour is the axes along which it lies beyond,
// as bits x, y, z, times 8, plus its corner there. Needs `tiles`, clusters_cells.glsl and clusters_table.glsl.

// The corners that are neighbours beyond these axes, as bits: those at the other end along these axes.
uint corners_beyond(uint corner, uint beyond) {
  const uint x = (corner & 1u) != 0u ? 0x55u : 0xaau;
  const uint y = (corner & 2u) != 0u ? 0x33u : 0xccu;
  const uint z = (corner & 4u) != 0u ? 0x0fu : 0xf0u;
  return ((beyond & 1u) != 0u ? x : 0xffu) & ((beyond & 2u) != 0u ? y : 0xffu) & ((beyond & 4u) != 0u ? z : 0xffu);
}

// Each pair of blocks is looked at from one side only. In its own tile, a block sees the later blocks. Outside, it sees
// the tiles along these sets of axes, as bits. For every set, one of any two opposite corners sees it, and no corner
// sees more than four sets.
uint tiles_to_see(uint corner) {
  return (corner < 4u ? 0x78d23c96u : 0x68c22c86u) >> 8u * (corner & 3u) & 0xffu;
}

// The corners that a block sees, as bits.
uint corners_to_see(uint corner, uint beyond) {
  if (beyond == 0u) return 0xffu & ~bits_below(corner);
  return (tiles_to_see(corner) >> beyond & 1u) != 0u ? corners_beyond(corner, beyond) : 0u;
}

// A tile as stored in its slot.
struct Tile {
  uint slot;
  uvec2 cells;  // none: the tile does not exist
};

// The tile that a block sees beyond these axes. Tiles of different solids are not neighbours.
Tile tile_beyond(TileKey key, uint corner, uint beyond, uint slots) {
  const uint plus = beyond & corner;
  const uint minus = beyond & ~corner;
  key.xy += (plus & 1u) - (minus & 1u) + ((plus & 2u) << 14u) - ((minus & 2u) << 14u);
  key.z_solid += (plus >> 2u) - (minus >> 2u);
  uint next = first_slot(key, slots);
  uint slot;
  uvec4 there;
  uint probe = 0u;
  for (;;) {
    slot = next;
    there = texelFetch(tiles, int(slot));
    next = next_slot(slot, slots);
    if (++probe >= slots || there.x == clusters_nothing || there.xy == uvec2(key.xy, key.z_solid)) break;
  }
  return Tile(slot, there.zw);
}
