// Looks for two contacts within the gap, one from a cell of block a, one from a cell of block b. One loop whose every turn
// tests one pair of contacts: devices that run a loop for many threads at once then waste little on the short ones. Needs
// `nodes`, `heads` and `push.limit`.

struct Search {
  uvec2 pairs;  // of cells, yet to do
  uint first_a;  // of block a's heads; exclusive or with a pair's cell
  uint first_b;
  bool found;
  bool open;  // there is more to test
};

Float3 at(uvec4 node) { return Float3(uintBitsToFloat(node.x), uintBitsToFloat(node.y), uintBitsToFloat(node.z)); }

// Tests up to `patience` pairs of contacts.
void go_on(inout Search s, uint patience) {
  uint next_a = fingers_nothing;  // contacts to test next
  uint next_b = fingers_nothing;
  uint head_b = fingers_nothing;
  uvec4 a = uvec4(0u);
  s.open = (s.pairs.x | s.pairs.y) != 0u;
  for (uint test = 0u; test < patience && s.open; ++test) {
    if (next_b == fingers_nothing) {
      if (next_a == fingers_nothing) {
        const uint pair = take_pair(s.pairs);
        next_a = heads[s.first_a ^ (pair >> 3u)];
        head_b = heads[s.first_b ^ (pair & 7u)];
      }
      a = nodes[next_a];
      next_a = a.w;
      next_b = head_b;
    }
    const uvec4 b = nodes[next_b];
    next_b = b.w;
    s.found = in_reach(at(a), at(b), push.limit);
    s.open = !s.found && (next_b != fingers_nothing || next_a != fingers_nothing || (s.pairs.x | s.pairs.y) != 0u);
  }
}
