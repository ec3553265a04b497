#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "skin.h"

// Which pixels of a view hold a point inside the box, and how many per group: the first half of the compaction.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = skin_depth) readonly buffer Depth { uvec4 depth[]; };
layout(std430, set = 0, binding = skin_rays) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = skin_blocks) writeonly buffer Blocks { uint blocks[]; };
layout(std430, set = 0, binding = skin_counts) writeonly buffer Counts { uint counts[]; };
layout(push_constant) uniform Push { SkinPush push; };

shared uint subgroup_sums[skin_group];

#include "skin_point.glsl"

void main() {
  const uint group = gl_WorkGroupID.x;
  const uint block = gl_GlobalInvocationID.x;
  uint survivors = 0u;
  if (block < push.blocks) {
    const uint row = block / push.blocks_per_row;
    const uint place = push.first_block + row * push.pitch_blocks + (block - row * push.blocks_per_row);
    const uvec4 words = depth[place];
    for (uint i = 0u; i < 8u; ++i) {
      const uint raw = raw_depth(words, i);
      if (raw - push.depth_low <= push.depth_span) {
        if (inside(skin_point(raw, rays[place * 8u + i]))) survivors |= 1u << i;
      }
    }
  }

  const uint count = bitCount(survivors);
  uint before = subgroupExclusiveAdd(count);
  const uint sum = subgroupAdd(count);
  if (gl_SubgroupInvocationID == 0u) subgroup_sums[gl_SubgroupID] = sum;
  barrier();
  for (uint i = 0u; i < gl_SubgroupID; ++i) before += subgroup_sums[i];

  blocks[(push.first_group + group) * skin_group + gl_LocalInvocationIndex] = survivors | before << 8;
  if (gl_LocalInvocationIndex == skin_group - 1u) counts[push.first_group + group] = before + count;
}
