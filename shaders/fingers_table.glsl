// The hash table of cells: open addressing, a slot per cell that holds contacts.

// At least twice as many slots as contacts, a power of two.
uint table_slots(uint contacts) {
  return contacts <= 32u ? 64u : 4u << findMSB(contacts - 1u);
}

uint cell_hash(ivec3 cell, uint solid) {
  uint h = uint(cell.x) * 0x9e3779b1u ^ uint(cell.y) * 0x85ebca77u ^ uint(cell.z) * 0xc2b2ae3du ^ solid * 0x27d4eb2fu;
  h = (h ^ h >> 15u) * 0x2c1b3c6du;
  return h ^ h >> 13u;
}
