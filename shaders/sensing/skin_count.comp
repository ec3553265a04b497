#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/sensing/skin.h"

// Finds the pixels of a crop with a point of skin inside the box, and their number per group: the first half of the
// compaction. Counts the points inside the box that are no skin.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Depth { uvec4 depth[]; };
layout(std430, set = 0, binding = 1) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Runs { SkinRun runs[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 4) readonly buffer Volumes { SkinVolume volumes[]; };
layout(std430, set = 0, binding = 5) readonly buffer Limits { uvec4 limits[]; };
layout(std430, set = 0, binding = 6) buffer Dropped { uint dropped[]; };
layout(push_constant) uniform Push { SkinPush push; };

layout(constant_id = 1) const uint drops = 0u;

#include "shaders/sensing/skin_point.glsl"

// In shared memory, not with subgroups: not every device has subgroup arithmetic, and no device promises its order.
const uint sum_threads = skin_group, sum_row = 8u;
#include "shaders/shared/sum_before.glsl"

// The pixels of a block that are looked at if only every `stride`-th one is.
uint wanted_pixels(uvec2 pixel, uint stride) {
  uint wanted = 0u;
  for (uint i = 0u; i < 8u; ++i) {
    if ((pixel.x + i) % stride == 0u) wanted |= 1u << i;
  }
  return wanted;
}

// The points of a block, and the points of the run that are no skin, by their reasons.
Float3 seen[8];
uint gone[4] = uint[4](0u, 0u, 0u, 0u);

// Those pixels of `block` whose point in `seen` is no skin. A volume is loaded once for all of them.
uint find_dropped(uint block, uint place, uvec4 words) {
  uint left = block;
  if ((drops & skin_drops_volumes) != 0u) {
    const uint count = volumes.length();
    for (uint v = 0u; v < count && left != 0u; ++v) {
      const SkinVolume volume = volumes[v];
      const uint before = left;
      for (uint i = 0u; i < 8u; ++i) {
        if ((left >> i & 1u) != 0u && drops_point(volume, seen[i])) left ^= 1u << i;
      }
      gone[volume.kind] += bitCount(before ^ left);
    }
  }
  if ((drops & skin_drops_background) != 0u && left != 0u) {
    const uvec4 limit = limits[place];
    const uint before = left;
    for (uint i = 0u; i < 8u; ++i) {
      if ((left >> i & 1u) != 0u && raw_depth(words, i) > raw_depth(limit, i)) left ^= 1u << i;
    }
    gone[skin_background] += bitCount(before ^ left);
  }
  return block ^ left;
}

uint find_survivors(uint first_block) {
  const Lens lens = read_lens();
  const uint depth_low = push.depth_range & 0xffffu;
  const uint depth_span = (push.depth_range >> 16) - depth_low;
  const uint end = min(first_block + skin_run_blocks, push.blocks);
  uvec2 pixel = block_pixel(first_block);
  uint survivors = 0u;
  uint bit = 1u;
  const uint stride = uint(lens.high.w);
  for (uint block = first_block; block < end; ++block) {
    if (stride > 1u && pixel.y % stride != 0u) {
      bit <<= 8;
      pixel = next_block(pixel);
      continue;
    }
    const uint place = place_of(pixel);
    const uvec4 words = depth[place];
    for (uint i = 0u; i < 8u; ++i) {
      const uint raw = raw_depth(words, i);
      if (raw - depth_low <= depth_span) {
        const vec2 ray = ray_of(lens, uvec2(pixel.x + i, pixel.y), place * 8u + i);
        const Float3 point = skin_point(lens, raw, ray);
        if (inside(lens, point)) {
          survivors |= bit;
          if (drops != 0u) seen[i] = point;
        }
      }
      bit <<= 1;
    }
    const uint shift = 8u * (block - first_block);
    if (stride > 1u) survivors &= ~(0xffu << shift) | wanted_pixels(pixel, stride) << shift;
    if (drops != 0u) survivors ^= find_dropped(survivors >> shift & 0xffu, place, words) << shift;
    pixel = next_block(pixel);
  }
  for (uint why = 0u; drops != 0u && why < 4u; ++why) {
    // The order of integer additions does not matter.
    if (gone[why] != 0u) atomicAdd(dropped[why], gone[why]);
  }
  return survivors;
}

void main() {
  const uint first_block = gl_GlobalInvocationID.x * skin_run_blocks;
  const uint survivors = first_block < push.blocks ? find_survivors(first_block) : 0u;
  const uint thread = gl_LocalInvocationIndex;
  const uint count = bitCount(survivors);
  const uint before = sum_before(count);
  const uint group = push.first_group + gl_WorkGroupID.x;
  runs[group * skin_group + thread] = SkinRun(survivors, before);
  if (thread == skin_group - 1u) counts[group] = before + count;
}
