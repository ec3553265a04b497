#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"
#include "shaders/touch/clusters/clusters_table.glsl"
#include "shaders/shared/scan.h"

// Every contact's tile and cell: finds the tile in the hash table and marks the cell as one with contacts. A tile's
// slot and a cell's first contact may differ from run to run, but no result of the pass depends on them.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = 1) uniform usamplerBuffer contacts;
layout(set = 0, binding = 2) uniform samplerBuffer solids;
layout(std430, set = 0, binding = 3) coherent buffer Tiles { uint tiles[]; };
layout(std430, set = 0, binding = 4) writeonly buffer Places { uint places[]; };
layout(push_constant) uniform Push { ClustersPush push; };

// One half of a slot's key: writes it if there is none yet. An existing key stays.
bool is_or_becomes(uint word, uint key) {
  uint there = tiles[word];
  if (there == clusters_nothing) there = atomicCompSwap(tiles[word], clusters_nothing, key);
  return there == key || there == clusters_nothing;
}

void main() {
  const uint count = min(found.total, push.most_contacts);
  const uint threads = gl_NumWorkGroups.x * contact_group;
  const uint slots = table_slots(count);
  for (uint i = gl_GlobalInvocationID.x; i < count; i += threads) {
    const vec3 point = uintBitsToFloat(texelFetch(contacts, int(2u * i)).xyz);
    const uint solid = texelFetch(contacts, int(2u * i + 1u)).x;
    const vec3 centre = texelFetch(solids, int(solid * clusters_solid_texels + clusters_centre_texel)).xyz;
    const uvec3 cell = uvec3(ivec3(floor((point - centre) * push.cells_per_metre)) + 65536);
    const uvec3 tile = cell >> 2u & 0x7fffu;
    const TileKey key = TileKey(tile.x | tile.y << 15u, tile.z | solid << 15u);
    const uvec3 in_tile = (cell >> 1u & 1u) << 3u | cell & 1u;
    const uint bit = in_tile.x | in_tile.y << 1u | in_tile.z << 2u;

    uint slot = first_slot(key, slots);
    for (uint probe = 0u; probe < slots; ++probe) {  // at least a third of the slots stay free
      if (is_or_becomes(4u * slot, key.xy) && is_or_becomes(4u * slot + 1u, key.z_solid)) break;
      slot = next_slot(slot, slots);
    }
    const uint word = 4u * slot + 2u + (bit >> 5u);
    const uint mark = 1u << (bit & 31u);
    const bool first = (tiles[word] & mark) == 0u && (atomicOr(tiles[word], mark) & mark) == 0u;
    places[i] = slot << 6u | bit | (first ? clusters_first : 0u);
  }
}
