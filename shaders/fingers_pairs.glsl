// Whether two cells hold a pair of contacts within the gap: exact. Needs `nodes` and `push.limit`.

bool within_gap(Slot one, Slot other) {
  uint a = one.head;
  for (uint i = 0u; i < one.count; ++i) {
    const Node p = nodes[a];
    uint b = other.head;
    for (uint j = 0u; j < other.count; ++j) {
      const Node q = nodes[b];
      if (in_reach(Float3(p.x, p.y, p.z), Float3(q.x, q.y, q.z), push.limit)) return true;
      b = q.next;
    }
    a = p.next;
  }
  return false;
}
