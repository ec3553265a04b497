// Two blocks that touch, as clusters_blocks lists them for clusters_link. Both words have the number of the block's
// first cell. Above it are the axes along which the two lie apart, and the axes along which the block that sees counts
// its cells from the far side, so that the cells that face the other block come first.
const uint link_cell_bits = 26u;  // contacts_most_points is less

struct Link {
  uint first_here;
  uint first_there;
  uint axes;       // as bits x, y, z
  uint face_here;  // of these axes
};

// `corner`, `there`: places of the two in their tiles; `beyond`: see clusters_neighbours.glsl.
uvec2 link_of(uint first_here, uint first_there, uint corner, uint beyond, uint there) {
  const uint axes = corner ^ there;
  return uvec2(first_here | axes << link_cell_bits, first_there | (axes & ~(corner ^ beyond)) << link_cell_bits);
}

Link link_from(uvec2 packed) {
  const uint cell = (1u << link_cell_bits) - 1u;
  return Link(packed.x & cell, packed.y & cell, packed.x >> link_cell_bits, packed.y >> link_cell_bits);
}
