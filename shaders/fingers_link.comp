#version 460
#extension GL_GOOGLE_include_directive : require
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"
#include "touch_math.h"

// Unites neighbouring cells that hold two contacts within the gap. A cell's contacts share its neighbours among themselves.
// Recorded twice: cells that touch, then those one further, most of which are then in one cluster already.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_nodes) readonly buffer Nodes { Node nodes[]; };
layout(std430, set = 0, binding = fingers_cells) readonly buffer Cells { CellKey cells[]; };
layout(std430, set = 0, binding = fingers_parents) coherent buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_places) readonly buffer Places { Place places[]; };
layout(std430, set = 0, binding = fingers_slots) readonly buffer Slots { Slot slots[]; };
layout(push_constant) uniform Push { FingersPush push; };

uint most_steps = 0u;
#include "fingers_union.glsl"
#include "fingers_pairs.glsl"

// The cells (x, y, z) + 2 of one half of the 5x5x5 block, base 5, nearest first: near[0..12], then the others.
const uint neighbours[fingers_neighbours] = uint[fingers_neighbours](
    63u, 67u, 87u, 66u, 68u, 82u, 86u, 88u, 92u, 81u, 83u, 91u, 93u, 64u, 72u, 112u,
    65u, 69u, 71u, 73u, 77u, 85u, 89u, 97u, 107u, 111u, 113u, 117u, 76u, 78u, 80u, 84u,
    90u, 94u, 96u, 98u, 106u, 108u, 116u, 118u, 70u, 74u, 102u, 110u, 114u, 122u, 75u, 79u,
    95u, 99u, 101u, 103u, 105u, 109u, 115u, 119u, 121u, 123u, 100u, 104u, 120u, 124u);

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const uint count = min(found.total, push.most_contacts);
  if (i >= count) return;
  most_steps = count;

  const Place place = places[i];
  const Slot here = slots[place.slot];
  const CellKey key = cells[i];
  const uint mask = table_slots(count) - 1u;
  for (uint n = push.first_neighbour + place.rank; n < push.end_neighbour; n += here.count) {
    const uint code = neighbours[n];
    const ivec3 cell = ivec3(key.x, key.y, key.z) + ivec3(code % 5u, code / 5u % 5u, code / 25u) - 2;
    uint slot = cell_hash(cell, key.solid) & mask;
    uint owner = slots[slot].owner;
    for (uint probe = 0u; probe <= mask && owner != fingers_nothing; ++probe) {
      if (cells[owner] == CellKey(cell.x, cell.y, cell.z, key.solid)) break;
      slot = (slot + 1u) & mask;
      owner = slots[slot].owner;
    }
    if (owner == fingers_nothing) continue;
    const Slot there = slots[slot];
    if (find_root(here.first) == find_root(there.first)) continue;
    if (within_gap(here, there)) unite(here.first, there.first);
  }
}
