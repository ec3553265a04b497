// The hash table of blocks: open addressing, a slot per block that holds contacts.

// At least twice as many slots as contacts, a power of two.
uint table_slots(uint contacts) {
  return contacts <= 32u ? 64u : 4u << findMSB(contacts - 1u);
}

uint block_hash(BlockKey key) {
  uint h = key.xy * 0x9e3779b1u ^ key.z_solid * 0x85ebca77u;
  h = (h ^ h >> 15u) * 0x2c1b3c6du;
  return h ^ h >> 13u;
}
