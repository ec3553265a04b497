// Common to the two skin shaders.

#include "shaders/sensing/skin_math.h"

layout(constant_id = 0) const uint rays_from_table = 1u;

// The push constants that every pixel needs, read once: inside branches, each use would be a separate load.
struct Lens {
  vec4 x, y, z;
  vec4 low, high;
  vec4 pinhole;
};

Lens read_lens() {
  return Lens(push.pose_x, push.pose_y, push.pose_z, push.box_low, push.box_high, push.pinhole);
}

// Column and row of the first pixel of the crop's block number `block`.
uvec2 block_pixel(uint block) {
  const uint per_row = push.row_blocks & 0xffffu;
  const uint row = block / per_row;
  return uvec2((push.corner & 0xffffu) + (block - row * per_row) * 8u, (push.corner >> 16) + row);
}

// The following block: the next row begins where the crop's row ends.
uvec2 next_block(uvec2 pixel) {
  const uint begin = push.corner & 0xffffu;
  const uint end = begin + (push.row_blocks & 0xffffu) * 8u;
  return pixel.x + 8u < end ? uvec2(pixel.x + 8u, pixel.y) : uvec2(begin, pixel.y + 1u);
}

// Where the pixel's block lies in the common arrangement.
uint place_of(uvec2 pixel) { return push.first_block + pixel.y * (push.row_blocks >> 16) + (pixel.x >> 3); }

uint raw_depth(uvec4 words, uint i) { return words[i >> 1] >> ((i & 1u) * 16u) & 0xffffu; }

vec2 ray_of(Lens lens, uvec2 pixel, uint table_index) {
  if (rays_from_table != 0u) return rays[table_index];
  precise const vec2 ray = (vec2(pixel) - lens.pinhole.xy) * lens.pinhole.zw;
  return ray;
}

Float3 skin_point(Lens lens, uint raw, vec2 ray) {
  const Float3 p = pixel_point(product(float(raw), lens.low.w), ray.x, ray.y);
  return Float3(in_frame(lens.x, p), in_frame(lens.y, p), in_frame(lens.z, p));
}

bool inside(Lens lens, Float3 p) {
  const vec3 point = vec3(p.x, p.y, p.z);
  return all(greaterThanEqual(point, lens.low.xyz)) && all(lessThanEqual(point, lens.high.xyz));
}
