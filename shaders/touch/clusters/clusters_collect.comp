#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/shared/scan.h"

// Numbers the cells that hold contacts, tile by tile, and lists the blocks with contacts. The data of the passes over
// blocks then lies close together, in whatever order the contacts came.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) writeonly buffer Nodes { uint nodes[]; };
layout(set = 0, binding = 2) uniform usamplerBuffer tiles;
layout(std430, set = 0, binding = 3) writeonly buffer Bases { uint bases[]; };
layout(std430, set = 0, binding = 4) writeonly buffer List { uint list[]; };
layout(std430, set = 0, binding = 5) buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 6) writeonly buffer Clusters { uvec2 clusters[]; };  // Cluster
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"

const uint run = collect_run;
const uint apart = 8u;  // between a thread's slots: tiles come in clusters, and adjacent threads share one

void main() {
  const uint slots = table_slots(min(found.total, push.most_contacts));
  const uint thread = gl_GlobalInvocationID.x;
  const uint stride = gl_NumWorkGroups.x * contact_group * run;
  for (uint first = thread / apart * (apart * run) + thread % apart; first < slots; first += stride) {
    const uint count = min(run, (slots - first + apart - 1u) / apart);
    uint taken = 0u;  // slots, as bits
    uint cells = 0u;
    uint blocks = 0u;
    for (uint k = 0u; k < count; ++k) {
      const uvec2 mask = texelFetch(tiles, int(first + k * apart)).zw;
      taken |= (mask.x | mask.y) != 0u ? 1u << k : 0u;
      cells += uint(bitCount(mask.x) + bitCount(mask.y));
      blocks += uint(bitCount(occupied_blocks(mask)));
    }
    if (taken == 0u) continue;
    uint cell = atomicAdd(work.cells, cells);
    uint place = atomicAdd(work.blocks, blocks);
    atomicMax(work.blocks_x, min((place + blocks + blocks_group - 1u) / blocks_group, blocks_most_groups));
    for (uint c = cell; c < cell + cells; ++c) {
      nodes[4u * c + 3u] = clusters_nothing;
      clusters[c] = uvec2(clusters_nothing, 0u);
    }
    for (;;) {
      uint s = 0u, there = 0u;
      if (taken != 0u) {
        s = first + uint(findLSB(taken)) * apart;
        taken &= taken - 1u;
        const uvec2 mask = texelFetch(tiles, int(s)).zw;
        bases[s] = cell;
        cell += uint(bitCount(mask.x) + bitCount(mask.y));
        there = occupied_blocks(mask);
      }
      for (;;) {
        if (there != 0u) {
          list[place++] = s << 3u | uint(findLSB(there));
          there &= there - 1u;
        }
        if (there == 0u) break;
      }
      if (taken == 0u) break;
    }
  }
}
