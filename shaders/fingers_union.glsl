// Lock-free union-find over `parents` (coherent). Roots are hooked under smaller roots, so that no two hooks can make a
// ring. Needs `most_steps`, a bound that no walk reaches.

uint find_root(uint a) {
  for (uint step = 0u; step < most_steps; ++step) {
    const uint parent = parents[a];
    if (parent == a) break;
    const uint above = parents[parent];
    if (above == parent) return parent;
    parents[a] = above;  // halves the path; `a` is no root, so no hook can be lost
    a = above;
  }
  return a;
}

void unite(uint a, uint b) {
  for (uint step = 0u; step < most_steps; ++step) {  // a failed hook means that someone else's succeeded
    a = find_root(a);
    b = find_root(b);
    if (a == b) return;
    const uint low = min(a, b);
    const uint high = max(a, b);
    if (atomicCompSwap(parents[high], high, low) == high) return;
  }
}
