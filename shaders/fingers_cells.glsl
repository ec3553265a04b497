// The cells of a block and their groups: cells that are known to be in one cluster. Eight times four bits: the lowest cell of
// the group that the cell is in, or 8 for a cell without contacts.

const uint no_group = 8u;

uint group_of(uint groups, uint cell) { return groups >> (4u * cell) & 15u; }

uint with_group(uint groups, uint cell, uint group) {
  return (groups & ~(15u << (4u * cell))) | group << (4u * cell);
}

// Cells of one group, as bits.
uint cells_of_group(uint groups, uint group) {
  uint cells = 0u;
  for (uint cell = 0u; cell < fingers_block_cells; ++cell) cells |= (group_of(groups, cell) == group ? 1u : 0u) << cell;
  return cells;
}

// The lowest cells of all groups, as bits.
uint first_cells(uint groups) {
  uint cells = 0u;
  for (uint cell = 0u; cell < fingers_block_cells; ++cell) cells |= (group_of(groups, cell) == cell ? 1u : 0u) << cell;
  return cells;
}

// Pairs (a, b) of two sets of cells, as 64 bits: bit 8 (a mod 4) + b of word a / 4.
uvec2 pairs_of(uint cells_a, uint cells_b) {
  uvec2 pairs = uvec2(0u);
  for (uint a = 0u; a < 4u; ++a) {
    pairs.x |= ((cells_a >> a & 1u) * cells_b) << (8u * a);
    pairs.y |= ((cells_a >> (a + 4u) & 1u) * cells_b) << (8u * a);
  }
  return pairs;
}

// Pairs (a, b) with a < b.
const uvec2 each_pair_once = uvec2(0xf0f8fcfeu, 0x0080c0e0u);

// Takes the lowest pair out of a set that is not empty: a * 8 + b.
uint take_pair(inout uvec2 pairs) {
  if (pairs.x != 0u) {
    const uint pair = uint(findLSB(pairs.x));
    pairs.x &= pairs.x - 1u;
    return pair;
  }
  const uint pair = uint(findLSB(pairs.y));
  pairs.y &= pairs.y - 1u;
  return 32u + pair;
}

// A set of cells with every cell's bits x, y, z flipped where `flip` has ones.
uint flipped(uint cells, uint flip) {
  if ((flip & 1u) != 0u) cells = (cells & 0x55u) << 1u | (cells & 0xaau) >> 1u;
  if ((flip & 2u) != 0u) cells = (cells & 0x33u) << 2u | (cells & 0xccu) >> 2u;
  if ((flip & 4u) != 0u) cells = (cells & 0x0fu) << 4u | (cells & 0xf0u) >> 4u;
  return cells;
}
