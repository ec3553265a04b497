#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "scan.h"

// Clusters large enough to be fingers, in the order of their smallest contacts, by a single group: each thread looks at a
// contiguous run of contacts and lists those that such a cluster begins with, where the run is in `begin`; the runs' finds are
// summed, then each thread writes its own. Of too many the largest: what few pixels pretend must not hide a finger.
layout(local_size_x = 256) in;

layout(std430, set = 0, binding = select_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = select_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = select_parents) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = select_clusters) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = select_contacts) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = select_header) writeonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = select_fingers) writeonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = select_begin) buffer Begin { uint begin[]; };
layout(push_constant) uniform Push { FingersPush push; };

// The size of the cluster that begins at contact i; else 0.
uint size_from(uint i) {
  const Cluster cluster = clusters[parents[i]];
  return cluster.smallest == i ? cluster.size : 0u;
}

shared uint sums[fingers_select_group];
shared uint histogram[fingers_select_group];  // of the sizes by one of their digits
shared uint bound;
shared uint wanted;

// The sum of what the threads before this one have; sums[fingers_select_group - 1] is that of all.
uint sum_before(uint mine) {
  const uint thread = gl_LocalInvocationIndex;
  barrier();
  sums[thread] = mine;
  barrier();
  for (uint step = 1u; step < fingers_select_group; step <<= 1u) {
    const uint left = thread >= step ? sums[thread - step] : 0u;
    barrier();
    sums[thread] += left;
    barrier();
  }
  return sums[thread] - mine;
}

// Of the clusters that begin[first] to begin[end - 1] are of: the size of the smallest that is taken, into `bound`, digit by
// digit from the top, and how many of that size are, into `wanted`.
void find_bound(uint first, uint end) {
  const uint thread = gl_LocalInvocationIndex;
  if (thread == 0u) {
    bound = 0u;
    wanted = fingers_most;
  }
  for (uint digit = 3u; digit > 0u; --digit) {
    const uint shift = 8u * (digit - 1u);
    histogram[thread] = 0u;
    barrier();
    for (uint k = first; k < end; ++k) {
      const uint size = size_from(begin[k]);
      if (size >> (shift + 8u) == bound >> (shift + 8u)) atomicAdd(histogram[size >> shift & 0xffu], 1u);
    }
    barrier();
    if (thread == 0u) {
      uint at = 0xffu;
      for (; at > 0u && histogram[at] < wanted; --at) wanted -= histogram[at];
      bound |= at << shift;
    }
    barrier();
  }
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(found.total, push.most_contacts);
  const uint run = (count + fingers_select_group - 1u) / fingers_select_group;
  const uint first = min(thread * run, count);
  const uint last = min(first + run, count);
  const uint least = max(push.min_points, 1u);

  uint mine = 0u;
  for (uint i = first; i < last; ++i) {
    if (size_from(i) >= least) begin[first + mine++] = i;
  }
  const uint end = first + mine;
  uint finger = sum_before(mine);
  const uint total = sums[fingers_select_group - 1u];
  uint over = least - 1u;  // larger ones are taken,
  uint equal = 0u;         // and so many of this thread's of just that size
  if (total > fingers_most) {  // the whole group
    find_bound(first, end);
    over = bound;
    uint larger = 0u, same = 0u;
    for (uint k = first; k < end; ++k) {
      const uint size = size_from(begin[k]);
      larger += size > over ? 1u : 0u;
      same += size == over ? 1u : 0u;
    }
    const uint before = sum_before(same);
    equal = min(same, wanted - min(wanted, before));
    mine = larger + equal;
    finger = sum_before(mine);
  }

  for (uint k = first; k < end && finger < fingers_most; ++k) {
    const uint i = begin[k], size = size_from(i);
    if (size < over || (size == over && equal == 0u)) continue;
    if (size == over) --equal;
    fingers[finger].first = i;
    fingers[finger].solid = contacts[i].solid;
    fingers[finger].contacts = size;
    ++finger;
  }
  if (thread == fingers_select_group - 1u) {
    header = TouchHeader(min(total, fingers_most), 1u, 1u, total, found.total, given.total, 0u, 0u);
  }
}
