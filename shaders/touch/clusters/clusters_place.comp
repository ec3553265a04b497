#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/shared/scan.h"

// Puts every contact into its cell's list, after the first. The lists' order may differ from run to run.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer contacts;
layout(std430, set = 0, binding = 2) buffer Nodes { uint nodes[]; };
layout(std430, set = 0, binding = 2) writeonly buffer NodesWhole { uvec4 whole_nodes[]; };  // the same
layout(set = 0, binding = 3) uniform usamplerBuffer tiles;
layout(set = 0, binding = 4) uniform usamplerBuffer bases;
layout(set = 0, binding = 5) uniform usamplerBuffer places;
layout(std430, set = 0, binding = 6) writeonly buffer Parents { uint parents[]; };
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const uint place = texelFetch(places, int(i)).x;
    const int slot = int((place & ~clusters_first) >> 6u);
    const uint cell = texelFetch(bases, slot).x + count_below(texelFetch(tiles, slot).zw, place & 63u);
    const bool first = (place & clusters_first) != 0u;
    const uint node = first ? cell : push.most_contacts + i;
    const uvec3 point = texelFetch(contacts, int(2u * i)).xyz;
    whole_nodes[node].xyz = point;
    if (!first) nodes[4u * node + 3u] = atomicExchange(nodes[4u * cell + 3u], node);
    parents[i] = cell;
  }
}
