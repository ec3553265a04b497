#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "scan.h"

// Clusters large enough to be fingers, in the order of their smallest contacts, by a single group: each thread looks at a
// contiguous run of contacts, the runs' finds are summed, then each thread writes its own.
layout(local_size_x = 256) in;

layout(std430, set = 0, binding = select_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = select_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = select_parents) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = select_clusters) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = select_contacts) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = select_header) writeonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = select_fingers) writeonly buffer Fingers { FingerRecord fingers[]; };
layout(push_constant) uniform Push { FingersPush push; };

// The size of the cluster that begins at contact i, else 0.
uint size_from(uint i) {
  const Cluster cluster = clusters[parents[i]];
  return cluster.smallest == i ? cluster.size : 0u;
}

shared uint sums[fingers_select_group];

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(found.total, push.most_contacts);
  const uint run = (count + fingers_select_group - 1u) / fingers_select_group;
  const uint first = min(thread * run, count);
  const uint last = min(first + run, count);
  const uint least = max(push.min_points, 1u);

  uint mine = 0u;
  for (uint i = first; i < last; ++i) mine += size_from(i) >= least ? 1u : 0u;
  sums[thread] = mine;
  barrier();
  for (uint step = 1u; step < fingers_select_group; step <<= 1u) {
    const uint left = thread >= step ? sums[thread - step] : 0u;
    barrier();
    sums[thread] += left;
    barrier();
  }

  uint finger = sums[thread] - mine;
  const uint end = finger + mine;
  for (uint i = first; i < last && finger < min(end, fingers_most); ++i) {
    const uint size = size_from(i);
    if (size < least) continue;
    fingers[finger].first = i;
    fingers[finger].solid = contacts[i].solid;
    fingers[finger].contacts = size;
    ++finger;
  }
  if (thread == fingers_select_group - 1u) {
    header = TouchHeader(min(end, fingers_most), 1u, 1u, end, found.total, given.total, 0u, 0u);
  }
}
