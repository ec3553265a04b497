// Shared by engine/touch/contacts.cpp, shaders/contacts_find.comp and shaders/contacts_pack.comp.
#ifndef PALPA_SHADERS_CONTACTS_H
#define PALPA_SHADERS_CONTACTS_H
#include "shared.h"
PALPA_SHADER_BEGIN

// One thread per skin point; one count per group.
PALPA_CONST contacts_group = 64u;
PALPA_CONST no_finger = 0xffffffffu;

// Bindings of contacts_find.
PALPA_CONST contacts_points = 0u;  // uvec4[]: bits of x, y, z; the point's index
PALPA_CONST contacts_length = 1u;  // ScanTotal of the points
PALPA_CONST contacts_hits = 2u;    // Hit[]: group g's contacts from 64 g on, in input order
PALPA_CONST contacts_counts = 3u;  // uint[]: contacts per group; after the scan those in the groups before
PALPA_CONST contacts_solids = 4u;  // SolidRecord[]
PALPA_CONST contacts_cells = 5u;   // PlaneCell[]
PALPA_CONST contacts_planes = 6u;  // vec4[]: normal, offset
PALPA_CONST contacts_find_buffers = 7u;
// Bindings of contacts_pack: the first four of contacts_find, then
PALPA_CONST contacts_total = 4u;  // ScanTotal of the contacts
PALPA_CONST contacts_out = 5u;    // ContactRecord[]
PALPA_CONST contacts_pack_buffers = 6u;

struct ContactsPush {
  vec4 low;  // box of the whole scene, world
  vec4 high;
  uint solids;
  float delta;
  uint most_points;
  uint most_contacts;
};
PALPA_CHECK_SIZE(ContactsPush, 48);
PALPA_CHECK_OFFSET(ContactsPush, solids, 32);
PALPA_CHECK_OFFSET(ContactsPush, most_contacts, 44);

// A convex solid. All its numbers are relative to its centre: the digits of single precision go to the solid's own size.
struct SolidRecord {
  vec4 centre;  // world
  vec4 low;     // box, relative to the centre, a little too large
  vec4 high;
  vec4 cells_per_metre;
  uint first_cell;
  uint cells_per_axis;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(SolidRecord, 80);
PALPA_CHECK_OFFSET(SolidRecord, cells_per_metre, 48);
PALPA_CHECK_OFFSET(SolidRecord, first_cell, 64);

// A cell of a solid's box: the planes that can be the nearest one somewhere in it, and bounds of Eq. (1)'s depth.
struct PlaneCell {
  uint first;  // in the list of planes
  uint count;
  float shallowest;
  float deepest;
};
PALPA_CHECK_SIZE(PlaneCell, 16);
PALPA_CHECK_OFFSET(PlaneCell, shallowest, 8);

struct Hit {
  uint place;  // point in its group (bits 0..5), solid (bits 6..)
  float depth;
};
PALPA_CHECK_SIZE(Hit, 8);
PALPA_CHECK_OFFSET(Hit, depth, 4);

struct ContactRecord {
  float x;
  float y;
  float z;
  uint point;
  uint solid;
  float depth;
  uint finger;  // index, or no_finger
  uint unused0;
};
PALPA_CHECK_SIZE(ContactRecord, 32);
PALPA_CHECK_OFFSET(ContactRecord, point, 12);
PALPA_CHECK_OFFSET(ContactRecord, solid, 16);
PALPA_CHECK_OFFSET(ContactRecord, depth, 20);
PALPA_CHECK_OFFSET(ContactRecord, finger, 24);

PALPA_SHADER_END
#endif
