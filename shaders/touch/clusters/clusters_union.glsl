// Lock-free union-find over `forest`. Roots are hooked under smaller roots, so two hooks can never make a ring. Walks
// go through `seen`, the same memory as texels. Its values may be out of date; a walk then ends at a former root.

#include "shaders/touch/clusters/clusters_walk.glsl"

void unite(uint a, uint b) {
  uint parent_a = a, parent_b = b;
  for (;;) {  // both walks at once
    a = parent_a;
    b = parent_b;
    parent_a = texelFetch(seen, int(a)).x;
    parent_b = texelFetch(seen, int(b)).x;
    if (parent_a >= a && parent_b >= b) break;
  }
  for (;;) {
    if (a != b) {
      const uint low = min(a, b);
      const uint high = max(a, b);
      const uint parent = atomicCompSwap(forest[high], high, low);
      a = parent == high ? low : parent;  // if `high` is no longer a root: continue from its parent, which is smaller
      b = low;
    }
    if (a == b) break;
  }
}
