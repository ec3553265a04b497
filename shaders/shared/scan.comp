#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/scan.h"

// Exclusive prefix sum over a few thousand counts by a single workgroup: each thread sums a contiguous run, a scan in
// shared memory adds up the runs' sums, then each thread writes the offsets of its run.
layout(local_size_x = 256) in;

layout(std430, set = 0, binding = 0) readonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Offsets { uint offsets[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Total { ScanTotal result; };
layout(push_constant) uniform Push { ScanPush push; };

const uint sum_threads = scan_group, sum_row = 16u;
#include "shaders/shared/sum_before.glsl"

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint run = (push.counts + scan_group - 1u) / scan_group;
  const uint first = min(thread * run, push.counts);
  const uint last = min(first + run, push.counts);

  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum += counts[i];
  const uint before = sum_before(sum);
  uint offset = before;
  for (uint i = first; i < last; ++i) {
    offsets[i] = offset;
    offset += counts[i];
  }
  if (thread == scan_group - 1u) {
    const uint total = min(before + sum, push.most_total);
    result.total = total;
    result.groups_x = scan_groups_of(total, push.groups);
    result.groups_y = 1u;
    result.groups_z = 1u;
  }
}
