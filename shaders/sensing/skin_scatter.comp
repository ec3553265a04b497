#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/sensing/skin.h"

// Writes the surviving points, in input order: the second half of the compaction.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Depth { uvec4 depth[]; };
layout(std430, set = 0, binding = 1) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 2) readonly buffer Runs { SkinRun runs[]; };
layout(std430, set = 0, binding = 3) readonly buffer Offsets { uint offsets[]; };
layout(std430, set = 0, binding = 4) writeonly buffer Points { vec4 points[]; };
layout(push_constant) uniform Push { SkinPush push; };

#include "shaders/sensing/skin_point.glsl"

void main() {
  const uint group = push.first_group + gl_WorkGroupID.x;
  const SkinRun run = runs[group * skin_group + gl_LocalInvocationIndex];
  if (run.survivors == 0u) return;

  const Lens lens = read_lens();
  const uint room = points.length();
  const uint width = push.width, first_index = push.first_index;
  uint slot = offsets[group] + run.before;
  uvec2 pixel = block_pixel(gl_GlobalInvocationID.x * skin_run_blocks);
  uint left = run.survivors;
  for (uint block = 0u; block < skin_run_blocks; ++block) {
    if ((left & 0xffu) != 0u) {
      const uint place = place_of(pixel);
      const uint index = first_index + pixel.y * width + pixel.x;
      const uvec4 words = depth[place];
      for (uint i = 0u; i < 8u; ++i) {
        if ((left >> i & 1u) != 0u) {
          if (slot < room) {
            const vec2 ray = ray_of(lens, uvec2(pixel.x + i, pixel.y), place * 8u + i);
            const Float3 point = skin_point(lens, raw_depth(words, i), ray);
            points[slot] = vec4(point.x, point.y, point.z, uintBitsToFloat(index + i));
          }
          ++slot;
        }
      }
    }
    left >>= 8;
    pixel = next_block(pixel);
  }
}
