// The hash table of blocks: open addressing, a slot per block that holds contacts. A word tells the block's owner and nine bits
// of its hash, which tell most other blocks apart without a look at their keys. The blocks of a tile, 4x4x2, have their slots
// side by side: neighbours are then looked up in memory that is already near.

const uint owner_bits = 0x7fffffu;  // room for more than contacts_most_points

// At least twice as many slots as contacts, a power of two.
uint table_slots(uint contacts) {
  return contacts <= 32u ? 64u : 4u << findMSB(contacts - 1u);
}

uint block_hash(BlockKey key) {
  uint h = (key.xy & 0xfffcfffcu) * 0x9e3779b1u ^ (key.z_solid & 0xfffffffeu) * 0x85ebca77u;
  h = (h ^ h >> 15u) * 0x2c1b3c6du;
  h ^= h >> 13u;
  const uint in_tile = (key.xy & 3u) | (key.xy >> 14u & 12u) | (key.z_solid & 1u) << 4u;
  return h ^ in_tile ^ in_tile << 27u;
}

// Where to look for a block: from one probe to the next a tile and a place on, so that every slot has its turn.
uint table_slot(uint hash, uint probe) { return hash + 33u * probe; }

bool may_be(uint word, uint hash) { return ((word ^ hash) & ~owner_bits) == 0u; }
