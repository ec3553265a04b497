// Walks up the union-find's trees, through `seen`.

uint seen_root(uint a) {
  uint parent = a;
  for (;;) {
    a = parent;
    parent = texelFetch(seen, int(a)).x;
    if (parent >= a) break;  // parents are smaller
  }
  return a;
}
