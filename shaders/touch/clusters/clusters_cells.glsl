// A tile's cells that hold contacts are 64 bits, a byte per block. A block's cells are numbered consecutively from
// `first`.
struct Block {
  uint first;
  uint occupied;  // cells, as bits
};

uint bits_below(uint bit) { return (1u << bit) - 1u; }

// The number of a tile's cells before this one that hold contacts.
uint count_below(uvec2 mask, uint bit) {
  const uvec2 below = bit < 32u ? uvec2(bits_below(bit), 0u) : uvec2(0xffffffffu, bits_below(bit & 31u));
  return uint(bitCount(mask.x & below.x) + bitCount(mask.y & below.y));
}

Block block_of(uint tile_first, uvec2 mask, uint block) {
  const uint occupied = (block < 4u ? mask.x : mask.y) >> 8u * (block & 3u) & 0xffu;
  return Block(tile_first + count_below(mask, 8u * block), occupied);
}

uint cell_number(Block of, uint cell) { return of.first + uint(bitCount(of.occupied & bits_below(cell))); }

// Bits 0, 8, 16 and 24, side by side.
uint each_eighth(uint bits) { return (bits & 0x01010101u) * 0x10204080u >> 28u; }

// The blocks of a tile that hold contacts, as bits.
uint occupied_blocks(uvec2 mask) {
  mask |= mask >> 4u;
  mask |= mask >> 2u;
  mask |= mask >> 1u;
  return each_eighth(mask.x) | each_eighth(mask.y) << 4u;
}

// Groups of a block's cells that are known to be in one cluster. Eight times four bits: the lowest cell of the group that the
// cell is in, or more than 7 for a cell without contacts.
const uint each_in_its_own = 0x76543210u;
const uint ones = 0x11111111u;

uint group_of(uint groups, uint cell) { return groups >> (4u * cell) & 15u; }

// Ones at each place where two words have the same four bits.
uint equal_fours(uint a, uint b) {
  uint differ = a ^ b;
  differ |= differ >> 2u;
  return ~(differ | differ >> 1u) & ones;
}

// The lowest bit of each four bits, eight times, side by side; and back.
uint gathered(uint fours) {
  fours = (fours | fours >> 3u) & 0x03030303u;
  fours = (fours | fours >> 6u) & 0x000f000fu;
  return (fours | fours >> 12u) & 0xffu;
}

uint spread(uint bits) {
  bits = (bits | bits << 12u) & 0x000f000fu;
  bits = (bits | bits << 6u) & 0x03030303u;
  return (bits | bits << 3u) & ones;
}

uint each_by_itself(uint occupied) { return each_in_its_own | spread(~occupied & 0xffu) << 3u; }

// The cells that hold contacts, as bits.
uint occupied_of(uint groups) { return ~gathered(groups >> 3u & ones) & 0xffu; }

// Cells of one group, as bits.
uint cells_of_group(uint groups, uint group) { return gathered(equal_fours(groups, group * ones)); }

// The lowest cells of all groups, as bits.
uint first_cells(uint groups) { return gathered(equal_fours(groups, each_in_its_own)); }

uint merged(uint groups, uint one, uint other) {
  const uint low = min(one, other);
  const uint high = max(one, other);
  return groups ^ equal_fours(groups, high * ones) * (high ^ low);
}

// Pairs (a, b) of two sets of cells, as 64 bits: bit 8 (a mod 4) + b of word a / 4.
uvec2 pairs_of(uint cells_a, uint cells_b) {
  const uvec2 four = uvec2(cells_a & 15u, cells_a >> 4u);
  return ((four | four << 7u | four << 14u | four << 21u) & 0x01010101u) * cells_b;
}

// Pairs (a, b) with a < b.
const uvec2 each_pair_once = uvec2(0xf0f8fcfeu, 0x0080c0e0u);

// Takes the lowest pair out of a set that is not empty: a * 8 + b.
uint take_pair(inout uvec2 pairs) {
  const bool low = pairs.x != 0u;
  const uint word = low ? pairs.x : pairs.y;
  pairs = low ? uvec2(word & (word - 1u), pairs.y) : uvec2(0u, word & (word - 1u));
  return uint(findLSB(word)) + (low ? 0u : 32u);
}

// The groups in the order of the cells after their bits x, y, z are flipped where `flip` has ones.
uint flipped(uint groups, uint flip) {
  const uint x = 4u * (flip & 1u), y = 4u * (flip & 2u), z = 4u * (flip & 4u);
  groups = (groups & 0x0f0f0f0fu) << x | (groups & 0xf0f0f0f0u) >> x;
  groups = (groups & 0x00ff00ffu) << y | (groups & 0xff00ff00u) >> y;
  return (groups & 0x0000ffffu) << z | (groups & 0xffff0000u) >> z;
}
