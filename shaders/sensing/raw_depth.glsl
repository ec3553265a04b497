// A pixel's raw depth. Needs `depth`, two raw depths a word, the even pixel in the low half.

uint raw_at(BridgeCamera camera, uint u, uint v) {
  const uint pixel = camera.first_pixel + v * camera.pitch + u;
  return depth[pixel >> 1u] >> ((pixel & 1u) * 16u) & 0xffffu;
}
