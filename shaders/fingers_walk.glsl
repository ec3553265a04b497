// Walks up the union-find's trees, through `seen`.

uint seen_root(uint a) {
  uint parent = texelFetch(seen, int(a)).x;
  while (parent < a) {  // parents are smaller
    a = parent;
    parent = texelFetch(seen, int(a)).x;
  }
  return a;
}
