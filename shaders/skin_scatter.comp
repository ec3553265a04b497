#version 460
#extension GL_GOOGLE_include_directive : require
#include "skin.h"

// Writes the surviving points, in input order: the second half of the compaction.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = skin_depth) readonly buffer Depth { uvec4 depth[]; };
layout(std430, set = 0, binding = skin_rays) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = skin_blocks) readonly buffer Blocks { uint blocks[]; };
layout(std430, set = 0, binding = skin_counts) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = skin_points) writeonly buffer Points { vec4 points[]; };
layout(push_constant) uniform Push { SkinPush push; };

#include "skin_point.glsl"

void main() {
  const uint block = gl_GlobalInvocationID.x;
  if (block >= push.blocks) return;
  const uint found = blocks[push.first_group * skin_group + block];
  if ((found & 0xffu) == 0u) return;

  const uint row = block / push.blocks_per_row;
  const uint column = block - row * push.blocks_per_row;
  const uint place = push.first_block + row * push.pitch_blocks + column;
  const uint index = push.first_index + row * push.width + column * 8u;
  const uvec4 words = depth[place];
  uint slot = counts[push.first_group + gl_WorkGroupID.x] + (found >> 8);
  for (uint i = 0u; i < 8u; ++i) {
    if ((found >> i & 1u) != 0u) {
      if (slot < push.most_points) {
        points[slot] = vec4(skin_point(raw_depth(words, i), rays[place * 8u + i]), uintBitsToFloat(index + i));
      }
      ++slot;
    }
  }
}
