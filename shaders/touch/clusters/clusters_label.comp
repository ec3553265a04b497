#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/shared/scan.h"

// Makes every contact's parent its cluster's root, and writes the cluster's smallest contact and its size at the root.
// Lists the roots of clusters that are large enough to be fingers.
layout(local_size_x = 128) in;
layout(constant_id = 0) const bool inside = false;  // deep points are clustered, too; they do not count towards sizes

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer contacts;
layout(set = 0, binding = 2) uniform usamplerBuffer seen;
layout(std430, set = 0, binding = 3) writeonly buffer Large { uint large[]; };
layout(std430, set = 0, binding = 4) buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 5) buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 6) coherent buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_walk.glsl"

void add(uint root, Cluster run) {
  if (root == clusters_nothing) return;
  if (run.smallest < clusters[root].smallest) atomicMin(clusters[root].smallest, run.smallest);
  if (run.size == 0u) return;
  const uint least = max(push.min_points, 1u);
  const uint before = atomicAdd(clusters[root].size, run.size);
  if (before < least && before + run.size >= least) large[atomicAdd(work.large, 1u)] = root;
}

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  Cluster run = Cluster(clusters_nothing, 0u);  // consecutive contacts of one cluster that this thread met
  uint root_of_run = clusters_nothing;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uint root = seen_root(parents[i]);
    parents[i] = root;
    if (root != root_of_run) {
      add(root_of_run, run);
      root_of_run = root;
      run = Cluster(i, 0u);
    }
    if (!inside || texelFetch(contacts, int(2u * i + 1u)).z == 0u) ++run.size;
  }
  add(root_of_run, run);
}
