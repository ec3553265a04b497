// Walks through the contacts of a block's cells. Needs `nodes`, `push.limit`, clusters_cells.glsl and clusters_math.h.

struct Walk {
  Block block;
  uint cells;    // still to come, as bits
  uint contact;  // clusters_nothing at the end
};

void skip_to_contact(inout Walk w) {
  if (w.contact == clusters_nothing && w.cells != 0u) {
    w.contact = cell_number(w.block, uint(findLSB(w.cells)));
    w.cells &= w.cells - 1u;
  }
}

Walk walk(Block block, uint cells) {
  Walk w = Walk(block, cells, clusters_nothing);
  skip_to_contact(w);
  return w;
}

bool at_end(Walk w) { return w.contact == clusters_nothing; }

vec3 take(inout Walk w) {
  const uvec4 node = texelFetch(nodes, int(w.contact));
  w.contact = node.w;
  skip_to_contact(w);
  return uintBitsToFloat(node.xyz);
}

// Whether the next contact, if there is one, is within the gap of p.
bool next_in_reach(inout Walk w, vec3 p) {
  if (at_end(w)) return false;
  const vec3 q = take(w);
  return in_reach(Float3(p.x, p.y, p.z), Float3(q.x, q.y, q.z), push.limit);
}
