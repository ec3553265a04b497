#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"

// Pairs of groups that took too many tests for one thread: every contact of the first group against every contact of
// the second. The contacts of the first are shared out among clusters_undecided_parts groups of threads. An iteration
// of a loop is several contacts, because a software device counts iterations; see clusters.h.
layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform usamplerBuffer nodes;
layout(std430, set = 0, binding = 1) readonly buffer Undecided { CrowdedPair undecided[]; };
layout(std430, set = 0, binding = 2) readonly buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 3) buffer Forest { uint forest[]; };
layout(set = 0, binding = 4) uniform usamplerBuffer seen;
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"
#include "shaders/touch/clusters/clusters_contacts.glsl"
#include "shaders/touch/clusters/clusters_undecided.glsl"
#include "shaders/touch/clusters/clusters_union.glsl"

void skip_one(inout Walk w) {
  if (at_end(w)) return;
  w.contact = texelFetch(nodes, int(w.contact)).w;
  skip_to_contact(w);
}

// `count`: a multiple of four.
void skip(inout Walk w, uint count) {
  for (uint k = 0u; k < count && !at_end(w); k += 4u) {
    skip_one(w);
    skip_one(w);
    skip_one(w);
    skip_one(w);
  }
}

bool any_in_reach(vec3 p, Walk others) {
  bool hit = false;
  while (!hit && !at_end(others)) {
    hit = next_in_reach(others, p);
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
    hit = next_in_reach(others, p) || hit;
  }
  return hit;
}

void main() {
  const uint pairs = min(work.undecided, undecided_room(push.most_contacts));
  const uint parts = clusters_undecided_parts * blocks_group;
  const uint part = gl_WorkGroupID.y * blocks_group + gl_LocalInvocationID.x;
  for (uint i = gl_WorkGroupID.x; i < pairs; i += gl_NumWorkGroups.x) {
    const CrowdedPair pair = undecided[i];
    const Block a = Block(pair.first_a, pair.cells_a & 0xffu);
    const Block b = Block(pair.first_b, pair.cells_b & 0xffu);
    const uint group_a = pair.cells_a >> 8u;
    const uint group_b = pair.cells_b >> 8u;
    const uint cell_a = cell_number(a, uint(findLSB(group_a)));
    const uint cell_b = cell_number(b, uint(findLSB(group_b)));
    const Walk others = walk(b, group_b);
    Walk mine = walk(a, group_a);
    skip(mine, part & ~3u);
    for (uint k = 0u; k < (part & 3u); ++k) skip_one(mine);
    while (!at_end(mine) && seen_root(cell_a) != seen_root(cell_b)) {
      if (any_in_reach(take(mine), others)) unite(cell_a, cell_b);
      skip(mine, parts - 4u);
      skip_one(mine);
      skip_one(mine);
      skip_one(mine);
    }
  }
}
