// Looks for contacts within the gap, one from a cell of block a, one from a cell of block b. A single loop tests one
// pair of contacts per iteration: devices that run a loop for many threads at once then waste little on the short ones.
// Needs `nodes`, `push.limit` and clusters_cells.glsl.

struct Search {
  uvec2 pairs;  // of cells, not done yet
  uint pair;    // of cells, being tested
  uvec4 a;      // the contact that is being tested against those of b's cell
  uint next_a;
  uint next_b;
  uint head_b;
};

Search search_in(uvec2 pairs) {
  return Search(pairs, 0u, uvec4(0u), clusters_nothing, clusters_nothing, clusters_nothing);
}

bool more(Search s) {
  return s.next_b != clusters_nothing || s.next_a != clusters_nothing || (s.pairs.x | s.pairs.y) != 0u;
}

// Leaves these pairs of cells untested.
void leave(inout Search s, uvec2 pairs) {
  s.pairs &= ~pairs;
  s.next_a = clusters_nothing;
  s.next_b = clusters_nothing;
}

Float3 at(uvec4 node) { return Float3(uintBitsToFloat(node.x), uintBitsToFloat(node.y), uintBitsToFloat(node.z)); }

// Tests one more pair of contacts; requires more(). `face_a` and `face_b` are combined by exclusive or with a pair's
// cells to give the blocks' cells.
bool test(inout Search s, Block a, Block b, uint face_a, uint face_b) {
  if (s.next_b == clusters_nothing) {
    if (s.next_a == clusters_nothing) {
      s.pair = take_pair(s.pairs);
      s.next_a = cell_number(a, face_a ^ (s.pair >> 3u));
      s.head_b = cell_number(b, face_b ^ (s.pair & 7u));
    }
    s.a = texelFetch(nodes, int(s.next_a));
    s.next_a = s.a.w;
    s.next_b = s.head_b;
  }
  const uvec4 other = texelFetch(nodes, int(s.next_b));
  s.next_b = other.w;
  return in_reach(at(s.a), at(other), push.limit);
}
