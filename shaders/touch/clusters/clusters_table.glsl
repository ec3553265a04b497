// The hash table of tiles: open addressing, a slot per tile that holds contacts. The 4x4x4 tiles of a cube have
// adjacent slots, so neighbours are looked up in memory that is already near. Needs clusters_math.h.

// A tile's coordinates from the solid's centre, biased by 2^14, 15 bits each, and the solid. Never clusters_nothing.
struct TileKey {
  uint xy;
  uint z_solid;
};

// The slot at which the search for a tile begins.
uint first_slot(TileKey key, uint slots) {
  uint h = (key.xy & ~0x18003u) * 0x9e3779b1u ^ (key.z_solid & ~3u) * 0x85ebca77u;
  h = (h ^ h >> 15u) * 0x2c1b3c6du;
  h ^= h >> 13u;
  uint group, rest;
  umulExtended(h, slots / table_group, group, rest);
  const uint in_cube = (key.xy & 3u) | (key.xy >> 13u & 12u) | (key.z_solid & 3u) << 4u;
  return group * table_group + (in_cube ^ (h & (table_group - 1u)));
}

// The slot after that: out of the group, by a power of three. It has no common divisor with the number of slots, so the
// search reaches every slot.
uint next_slot(uint slot, uint slots) {
  slot += 81u;
  return slot < slots ? slot : slot - slots;
}
