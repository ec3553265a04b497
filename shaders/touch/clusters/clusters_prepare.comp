#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/shared/scan.h"

// Makes an empty hash table. The only work that follows is to collect its contents.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) writeonly buffer Tiles { uvec4 tiles[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Work { ClustersWork work; };
layout(push_constant) uniform Push { ClustersPush push; };

void main() {
  const uint slots = table_slots(min(found.total, push.most_contacts));
  const uint threads = gl_NumWorkGroups.x * contact_group;
  if (gl_GlobalInvocationID.x == 0u) {
    const uint collect = (slots + collect_run * contact_group - 1u) / (collect_run * contact_group);
    work = ClustersWork(min(collect, contacts_most_groups), 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u, 0u, 0u,
                        clusters_undecided_parts, 1u, 0u, 0u, 1u, 1u, 0u);
  }
  for (uint s = gl_GlobalInvocationID.x; s < slots; s += threads) {
    tiles[s] = uvec4(clusters_nothing, clusters_nothing, 0u, 0u);
  }
}
