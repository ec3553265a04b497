#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_table.glsl"
#include "scan.h"

// Every contact's cell, every contact its own cluster, and an empty hash table.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = fingers_nodes) writeonly buffer Nodes { Node nodes[]; };
layout(std430, set = 0, binding = fingers_cells) writeonly buffer Cells { CellKey cells[]; };
layout(std430, set = 0, binding = fingers_parents) writeonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = fingers_places) writeonly buffer Places { Place places[]; };
layout(std430, set = 0, binding = fingers_slots) writeonly buffer Slots { Slot slots[]; };
layout(std430, set = 0, binding = fingers_sizes) writeonly buffer Sizes { uint sizes[]; };
layout(std430, set = 0, binding = fingers_contacts) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = fingers_solids) readonly buffer Solids { SolidRecord solids[]; };
layout(push_constant) uniform Push { FingersPush push; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  const uint count = min(found.total, push.most_contacts);
  const uint table = table_slots(count);
  const uint threads = gl_NumWorkGroups.x * fingers_group;
  for (uint s = i; s < table; s += threads) slots[s] = Slot(fingers_nothing, fingers_nothing, 0u, fingers_nothing);
  if (i >= count) return;

  const ContactRecord contact = contacts[i];
  const vec3 centre = solids[contact.solid].centre.xyz;
  const ivec3 cell = ivec3(floor((vec3(contact.x, contact.y, contact.z) - centre) * push.cells_per_metre));
  nodes[i] = Node(contact.x, contact.y, contact.z, fingers_nothing);
  cells[i] = CellKey(cell.x, cell.y, cell.z, contact.solid);
  parents[i] = i;
  places[i] = Place(0u, 0u);
  sizes[i] = 0u;
}
