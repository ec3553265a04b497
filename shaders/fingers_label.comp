#version 460
#extension GL_GOOGLE_include_directive : require
#include "fingers.h"
#include "scan.h"

// Every contact's parent becomes its cluster's smallest contact, where the cluster's size is counted, cell by cell.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_parents) coherent buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_places) readonly buffer Places { Place places[]; };
layout(std430, set = 0, binding = fingers_slots) readonly buffer Slots { Slot slots[]; };
layout(std430, set = 0, binding = fingers_sizes) buffer Sizes { uint sizes[]; };
layout(push_constant) uniform Push { FingersPush push; };

uint most_steps = 0u;
#include "fingers_union.glsl"

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const uint count = min(found.total, push.most_contacts);
  if (i >= count) return;
  most_steps = count;

  const Place place = places[i];
  const Slot cell = slots[place.slot];
  const uint root = find_root(cell.first);
  parents[i] = root;
  if (place.rank == 0u) atomicAdd(sizes[root], cell.count);
}
