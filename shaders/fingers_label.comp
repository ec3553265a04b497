#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "scan.h"

// Every contact's parent becomes its cluster's root; at the root: the cluster's smallest contact and its size.
layout(local_size_x = 128) in;
layout(constant_id = 0) const bool inside = false;  // deep points are clustered too: they count for no size

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_contacts) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = fingers_places) readonly buffer Places { uint places[]; };
layout(std430, set = 0, binding = fingers_heads) readonly buffer Heads { uint heads[]; };
layout(std430, set = 0, binding = fingers_parents) coherent buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_clusters) coherent buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { FingersPush push; };

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    // No halving of paths here: it could put a mere ancestor in place of a root that another thread has just written.
    uint root = heads[places[i]];
    for (uint step = 0u; step < count && parents[root] != root; ++step) root = parents[root];
    parents[i] = root;
    if (clusters[root].smallest > i) atomicMin(clusters[root].smallest, i);
    if (!inside || contacts[i].finger != fingers_deep) atomicAdd(clusters[root].size, 1u);
  }
}
