#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/shared/scan.h"

// Clusters large enough to be fingers, in the order of their smallest contacts, by a single group. If there are too
// many, it takes the largest, and of equally large ones those that begin first: a few wrong pixels must not hide a
// finger.
layout(local_size_x = 256) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = 2) readonly buffer Large { uint large[]; };
layout(std430, set = 0, binding = 3) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = 4) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 5) writeonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 6) writeonly buffer Selected { ClusterRecord selected[]; };
layout(std430, set = 0, binding = 7) readonly buffer Work { ClustersWork work; };

// Sizes and contacts are below 2^24: three digits of eight bits.
const uint digits = 3u;
const uint last_contact = 0xffffffu;

shared uint histogram[clusters_select_group];  // of one digit
shared uint bound;
shared uint wanted;
shared uint taken;
shared Cluster chosen[clusters_most_selected];

// The numbers by which clusters are sorted: their sizes. With `size`, for the clusters of this size: the distance of
// their beginning from the last contact.
uint number_of(Cluster cluster, uint size) {
  if (size == 0u) return cluster.size;
  return cluster.size == size ? last_contact - cluster.smallest : clusters_nothing;
}

void tally(uint k, uint listed, uint size, uint shift) {
  if (k >= listed) return;
  const uint number = number_of(clusters[large[k]], size);
  if (number >> (shift + 8u) == bound >> (shift + 8u)) atomicAdd(histogram[number >> shift & 0xffu], 1u);
}

// Finds the smallest of the `wanted` largest numbers, digit by digit from the top, and writes it to `bound`. The number
// of those that are equal to it goes to `wanted`.
void find_bound(uint listed, uint size) {
  const uint thread = gl_LocalInvocationIndex;
  barrier();
  if (thread == 0u) bound = 0u;
  for (uint digit = digits; digit > 0u; --digit) {
    const uint shift = 8u * (digit - 1u);
    histogram[thread] = 0u;
    barrier();
    for (uint k = thread; k < listed; k += 4u * clusters_select_group) {
      tally(k, listed, size, shift);
      tally(k + clusters_select_group, listed, size, shift);
      tally(k + 2u * clusters_select_group, listed, size, shift);
      tally(k + 3u * clusters_select_group, listed, size, shift);
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

// Takes the cluster if it is larger than `size`, or just as large and begins with `last` or before.
void take(uint k, uint listed, uint size, uint last) {
  if (k >= listed) return;
  const Cluster cluster = clusters[large[k]];
  if (cluster.size > size || (cluster.size == size && cluster.smallest <= last)) chosen[atomicAdd(taken, 1u)] = cluster;
}

// (A software device ends all loops of a shader after 65,535 iterations together, so an iteration is four clusters.)
void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint listed = work.large;
  uint size = 0u, last = last_contact;
  if (thread == 0u) {
    taken = 0u;
    wanted = clusters_most_selected;
  }
  barrier();
  if (listed > clusters_most_selected) {  // the whole group
    find_bound(listed, 0u);
    size = bound;
    find_bound(listed, size);
    last = last_contact - bound;
  }
  for (uint k = thread; k < listed; k += 4u * clusters_select_group) {
    take(k, listed, size, last);
    take(k + clusters_select_group, listed, size, last);
    take(k + 2u * clusters_select_group, listed, size, last);
    take(k + 3u * clusters_select_group, listed, size, last);
  }
  barrier();
  if (thread < taken) {
    const Cluster cluster = chosen[thread];
    uint place = 0u;
    for (uint other = 0u; other < taken; ++other) place += chosen[other].smallest < cluster.smallest ? 1u : 0u;
    selected[place] = ClusterRecord(cluster.smallest, contacts[cluster.smallest].solid, cluster.size, 0u);
  }
  if (thread == 0u) header = TouchHeader(taken, listed, found.total, given.total);
}
