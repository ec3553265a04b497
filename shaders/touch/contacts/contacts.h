// Shared by engine/touch/contacts/contacts_pass.cpp, shaders/touch/contacts/contacts_find.comp,
// shaders/touch/contacts/contacts_surface.comp and shaders/touch/contacts/contacts_pack.comp.
#ifndef PALPA_SHADERS_CONTACTS_H
#define PALPA_SHADERS_CONTACTS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// The points are cut into contacts_chunks chunks of whole rounds of a group, one group each. Their number is small
// because starting one costs a software device a microsecond, and then their counts need no separate scan. There are
// more only if a thread would otherwise look at too much, see contacts_most_iterations. The number is always a multiple
// of four.
PALPA_CONST contacts_group = 64u;
PALPA_CONST contacts_chunks = 64u;
// The most that a thread may look at: a software device ends all loops of a shader after 65,535 iterations together.
PALPA_CONST contacts_most_iterations = 60000u;
PALPA_CONST contacts_most_words = 2048u;  // of 32 points each, in a chunk
PALPA_CONST contacts_most_points = 4000000u;

// Passes over contacts: threads stride over them in at most contacts_most_groups groups.
PALPA_CONST contact_group = 128u;
PALPA_CONST contacts_most_groups = 128u;

// Contents of the buffers, beside structs:
//   points      uvec4[]: bits of x, y, z; the point's index
//   length      ScanTotal of the points
//   hits        Hit[]: per point, written for contacts only
//   masks       uint[]: which of 32 points are contacts; for contacts_pack also which are deep points
//   counts      uint[]: contacts per chunk; for contacts_pack also deep points
//   planes      vec4[]: normal, offset
//   deep_masks, deep_counts: the same for deep points, if they are asked for
// contacts_surface reads these as texels, see surface.h: surface_cells, two words a texel; surface_runs; and with four
// words a texel surface_triangles, surface_signs, surface_corners, and parts_words, see parts_depth.h.

// A solid. All its numbers are relative to its centre, in the axes that it has at rest, so the digits of single
// precision all serve the solid's own size.
struct SolidRecord {
  vec4 turn;    // unit quaternion x, y, z, w that turns the world's axes into the solid's
  vec4 centre;  // world
  vec4 low;     // box, a little too large
  vec4 high;
  vec4 cells_per_metre;
  uint first_cell;      // in the plane cells, or in the surface cells; for parts, the base in their words
  uint cells_per_axis;  // of the plane cells; of a surface's grid see surface_axis_bits
  float delta;          // 0: the push constant's
  uint asked_by;        // one of the next three values
};
PALPA_CONST asked_by_planes = 0u;  // a convex solid
PALPA_CONST asked_by_surface = 1u;
PALPA_CONST asked_by_parts = 2u;  // a solid of convex parts
PALPA_CHECK_SIZE(SolidRecord, 96);
PALPA_CHECK_OFFSET(SolidRecord, centre, 16);
PALPA_CHECK_OFFSET(SolidRecord, cells_per_metre, 64);
PALPA_CHECK_OFFSET(SolidRecord, first_cell, 80);
PALPA_CHECK_OFFSET(SolidRecord, delta, 88);

struct ContactsPush {
  SolidRecord only;  // the solid of a scene with only one: devices read push constants faster than buffers
  uint solids;
  float delta;
  uint most_points;
  uint most_contacts;
  uint elapsed_us;  // from the frame before, or reach_none: contacts do not reach beyond the shell's edges
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(ContactsPush, 128);
PALPA_CHECK_OFFSET(ContactsPush, solids, 96);
PALPA_CHECK_OFFSET(ContactsPush, most_contacts, 108);

// A cell of a solid's box: the planes that can be the nearest one anywhere in it, and bounds of Eq. (1)'s depth.
struct PlaneCell {
  uint first;  // in the list of planes
  uint count;
  float shallowest;
  float deepest;
};
PALPA_CHECK_SIZE(PlaneCell, 16);
PALPA_CHECK_OFFSET(PlaneCell, shallowest, 8);

struct Hit {
  uint solid;  // plus hit_beyond for a contact beyond an edge
  float depth;
};
PALPA_CONST hit_beyond = 0x80000000u;
PALPA_CHECK_SIZE(Hit, 8);
PALPA_CHECK_OFFSET(Hit, depth, 4);

struct ContactRecord {
  float x;
  float y;
  float z;
  uint point;
  uint solid;
  float depth;
  uint deep;    // 1: a deep point, in the list of both that clusters_gather makes
  uint beyond;  // 1: it is beyond an edge of the shell, for a known finger that is about to end
};
PALPA_CHECK_SIZE(ContactRecord, 32);
PALPA_CHECK_OFFSET(ContactRecord, point, 12);
PALPA_CHECK_OFFSET(ContactRecord, solid, 16);
PALPA_CHECK_OFFSET(ContactRecord, depth, 20);
PALPA_CHECK_OFFSET(ContactRecord, deep, 24);

PALPA_SHADER_END
#endif
