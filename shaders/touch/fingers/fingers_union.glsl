// Lock-free union-find over `forest`. Roots are hooked under smaller roots, so that no two hooks can make a ring. Walks go
// through `seen`, the same memory as texels: what they see may be old, and then they end at what was a root once.

#include "shaders/touch/fingers/fingers_walk.glsl"

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
      a = parent == high ? low : parent;  // if `high` was no root any more: on from its parent, which is smaller
      b = low;
    }
    if (a == b) break;
  }
}
