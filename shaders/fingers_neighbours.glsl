// Finds the blocks that touch a block, each pair of blocks from one side only. Needs `slots` and `keys`.

// The neighbours (x, y, z) + 1, base 3: the block itself, sides, edges, corners.
const uint neighbours[fingers_neighbours] =
    uint[fingers_neighbours](13u, 14u, 16u, 22u, 15u, 17u, 19u, 21u, 23u, 25u, 18u, 20u, 24u, 26u);

BlockKey key_of(uint owner) {
  const uvec2 words = texelFetch(keys, int(owner)).xy;
  return BlockKey(words.x, words.y);
}

// Where a neighbour lies; solids do not mix.
BlockKey neighbour_of(BlockKey key, uint code) {
  const uvec3 block = uvec3(key.xy & 0xffffu, key.xy >> 16u, key.z_solid & 0xffffu) +
                      uvec3(code % 3u, code / 3u % 3u, code / 9u) - 1u;
  return BlockKey(block.x | block.y << 16u, block.z | (key.z_solid & 0xffff0000u));
}

// Whether there may be such a block: true where there is, and where a slot only looks like it. `mask`: slots - 1.
bool may_be_there(BlockKey key, uint mask) {
  const uint hash = block_hash(key);
  uint word = texelFetch(slots, int(table_slot(hash, 0u) & mask)).x;
  for (uint probe = 1u; probe <= mask && word != fingers_nothing && !may_be(word, hash); ++probe) {
    word = texelFetch(slots, int(table_slot(hash, probe) & mask)).x;
  }
  return word != fingers_nothing;
}

// The owner of the block, or fingers_nothing.
uint owner_of(BlockKey key, uint mask) {
  const uint hash = block_hash(key);
  for (uint probe = 0u; probe <= mask; ++probe) {
    const uint word = texelFetch(slots, int(table_slot(hash, probe) & mask)).x;
    if (word == fingers_nothing) break;
    const uint owner = word & owner_bits;
    if (may_be(word, hash) && key_of(owner) == key) return owner;
  }
  return fingers_nothing;
}
