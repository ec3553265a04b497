#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/scan.h"

// Exclusive prefix sum over a few thousand counts by a single workgroup: each thread sums a contiguous run, a scan in
// shared memory adds up the runs' sums, then each thread rewrites its run.
layout(local_size_x = 256) in;

layout(std430, set = 0, binding = 0) buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 1) readonly buffer Length { uint items; };
layout(std430, set = 0, binding = 2) writeonly buffer Total { ScanTotal result; };
layout(push_constant) uniform Push { ScanPush push; };

const uint sum_threads = scan_group, sum_row = 16u;
#include "shaders/shared/sum_before.glsl"

void main() {
  const uint thread = gl_LocalInvocationIndex;
  uint count = push.most_counts;
  if (push.items_per_count != 0u) {
    count = min(count, (items + push.items_per_count - 1u) / push.items_per_count);
  }
  const uint run = (count + scan_group - 1u) / scan_group;
  const uint first = min(thread * run, count);
  const uint last = min(first + run, count);

  uint sum = 0u;
  for (uint i = first; i < last; ++i) sum += counts[i];
  const uint before = sum_before(sum);
  uint offset = before;
  for (uint i = first; i < last; ++i) {
    const uint here = counts[i];
    counts[i] = offset;
    offset += here;
  }
  if (thread == scan_group - 1u) {
    const uint total = min(before + sum, push.most_total);
    result.total = total;
    result.groups_x = scan_groups_of(total, push.groups);
    result.groups_y = 1u;
    result.groups_z = 1u;
  }
}
