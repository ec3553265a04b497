// Shared by engine/touch/fingers/fingers_pass.cpp and shaders/fingers_*.comp.
#ifndef PALPA_SHADERS_FINGERS_H
#define PALPA_SHADERS_FINGERS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST fingers_select_group = 256u;  // a single group
PALPA_CONST fingers_most = 64u;
PALPA_CONST fingers_nothing = 0xffffffffu;

// Cells have this side, in thousandths of the finger gap. Anything up to 1/sqrt(3) = 0.577 keeps two contacts of one
// cell within the gap, anything above 0.5 keeps contacts three cells apart beyond it; 0.52 leaves room for rounding on
// both sides, up to fingers_most_blocks blocks from a solid's centre. A block is 2x2x2 cells: contacts of blocks that
// do not touch are beyond the gap. A tile is 2x2x2 blocks. Both are numbered along x, then y, then z.
PALPA_CONST fingers_cell_thousandths = 520u;
PALPA_CONST fingers_most_blocks = 30000u;

PALPA_CONST collect_run = 32u;  // slots of the hash table that a thread of fingers_collect looks at at once

// Groups of the passes over blocks.
PALPA_CONST blocks_group = 64u;
PALPA_CONST blocks_most_groups = 256u;
PALPA_CONST rest_most_groups = 16384u;
// Tests of two blocks before their groups of cells that are still apart are put on the list of crowded ones.
PALPA_CONST fingers_patience = 32u;
// Room on that list. When it or that of blocks that touch (links_room() in fingers_math.h) runs out, a pass tests
// everything again, pair by pair: slow, but no less exact.
PALPA_CONST fingers_crowded_per_contact = 1u;
// A software device ends all loops of a shader after 65,535 iterations together, and what they were about to say is
// then anything. So a thread looks at few pairs of contacts and lists what it could not decide; for a pair of groups
// there, the first one's contacts go to so many groups of blocks_group threads. That is enough for 20,000 contacts in
// each of the two.
PALPA_CONST fingers_rest_patience = 2048u;
PALPA_CONST fingers_undecided_parts = 16u;

// What the buffers hold, beside structs. What a shader only reads it reads as texels, see engine/gpu/texel_view.hpp.
//   nodes            uvec4[]: bits of x, y, z and the next one in the cell's list: the first of a cell has the cell's
//                    number, the others their contact's plus most_contacts
//   tiles            uvec4[]: hash table: a TileKey, see fingers_table.glsl, and 64 cells as bits
//   bases            uint[]: per slot its first cell's number
//   places           uint[]: per contact its slot times 64, plus its cell there, or fingers_first
//   list             uint[]: the blocks that hold contacts: slot times 8, plus the block there
//   links            uvec2[]: two blocks that touch, see fingers_links.glsl
//   groups_of_block  uint[]: at a block's first cell's number, see fingers_cells.glsl
//   crowded          CrowdedPair[]
//   undecided        CrowdedPair[]: those that stayed undecided
//   left             where fingers_link lists what it leaves: one of these two
//   forest           uint[]: union-find over cells
//   seen             the forest as texels: while others write it perhaps not the newest
//   large            uint[]: roots of clusters that may be fingers, in any order
//   parents          uint[]: per contact its cell's number; at the end that of its root
//   clusters         Cluster[]: per root
//   inside           ContactRecord[]: the contacts, then the deep points, `finger` fingers_deep
PALPA_CONST fingers_first = 0x80000000u;  // of its cell
PALPA_CONST fingers_solid_texels = 6u;
PALPA_CONST fingers_centre_texel = 1u;
PALPA_CONST fingers_deep = 0xfffffffeu;

struct GatherPush {
  uint most_contacts;
  uint most_deep;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(GatherPush, 16);
PALPA_CHECK_OFFSET(GatherPush, most_deep, 4);

struct FingersPush {
  float cells_per_metre;
  float limit;  // the gap's square
  uint most_contacts;
  uint min_points;
};
PALPA_CHECK_SIZE(FingersPush, 16);
PALPA_CHECK_OFFSET(FingersPush, most_contacts, 8);
PALPA_CHECK_OFFSET(FingersPush, min_points, 12);

// Two groups of cells with many contacts each. Of both: their block's first cell; its cells that hold contacts as bits,
// plus 256 times those of the group.
struct CrowdedPair {
  uint first_a;
  uint first_b;
  uint cells_a;
  uint cells_b;
};
PALPA_CHECK_SIZE(CrowdedPair, 16);
PALPA_CHECK_OFFSET(CrowdedPair, cells_a, 8);

// How much there is to do, and the indirect dispatches that do it.
struct FingersWork {
  uint collect_x;
  uint collect_y;
  uint collect_z;
  uint cells;
  uint blocks_x;
  uint blocks_y;
  uint blocks_z;
  uint blocks;
  uint links_x;
  uint links_y;
  uint links_z;
  uint links;
  uint crowded_x;
  uint crowded_y;
  uint crowded_z;
  uint crowded;
  uint undecided_x;
  uint undecided_y;
  uint undecided_z;
  uint undecided;
  uint rest_x;  // none unless the list of links or that of crowded pairs ran out
  uint rest_y;
  uint rest_z;
  uint large;  // clusters that may be fingers
};
PALPA_CHECK_SIZE(FingersWork, 96);
PALPA_CHECK_OFFSET(FingersWork, cells, 12);
PALPA_CHECK_OFFSET(FingersWork, blocks, 28);
PALPA_CHECK_OFFSET(FingersWork, links_x, 32);
PALPA_CHECK_OFFSET(FingersWork, links, 44);
PALPA_CHECK_OFFSET(FingersWork, crowded_x, 48);
PALPA_CHECK_OFFSET(FingersWork, crowded, 60);
PALPA_CHECK_OFFSET(FingersWork, undecided_x, 64);
PALPA_CHECK_OFFSET(FingersWork, undecided, 76);
PALPA_CHECK_OFFSET(FingersWork, rest_x, 80);
PALPA_CHECK_OFFSET(FingersWork, large, 92);

struct Cluster {
  uint smallest;  // contact
  uint size;
};
PALPA_CHECK_SIZE(Cluster, 8);

// What the host reads first; its first three words dispatch one group per finger. Behind `points` are the dispatches of
// those who look at the fingers again, with no group where there is nothing for them to do: a software device takes
// longer to start a group than to see that it is not needed.
struct TouchHeader {
  uint fingers;
  uint groups_y;
  uint groups_z;
  uint clusters;
  uint contacts;
  uint points;
  uint look_x;  // split_look: up to the last finger that is too wide
  uint look_y;
  uint look_z;
  uint parts_x;  // split_parts: the same
  uint parts_y;
  uint parts_z;
  uint assign_x;  // split_assign: over the contacts where one is
  uint assign_y;
  uint assign_z;
  uint list_x;  // split_list: where one is too wide or no finger
  uint list_y;
  uint list_z;
  uint patches_x;  // bridge_sample, bridge_pairs: one per finger where there are two
  uint patches_y;
  uint patches_z;
  uint join_x;  // bridge_join: where there are two
  uint join_y;
  uint join_z;
  uint relabel_x;  // bridge_relabel: over the contacts where any two are one
  uint relabel_y;
  uint relabel_z;
};
PALPA_CHECK_SIZE(TouchHeader, 108);
PALPA_CHECK_OFFSET(TouchHeader, look_x, 24);
PALPA_CHECK_OFFSET(TouchHeader, parts_x, 36);
PALPA_CHECK_OFFSET(TouchHeader, assign_x, 48);
PALPA_CHECK_OFFSET(TouchHeader, list_x, 60);
PALPA_CHECK_OFFSET(TouchHeader, patches_x, 72);
PALPA_CHECK_OFFSET(TouchHeader, join_x, 84);
PALPA_CHECK_OFFSET(TouchHeader, relabel_x, 96);
PALPA_CHECK_OFFSET(TouchHeader, clusters, 12);
PALPA_CHECK_OFFSET(TouchHeader, points, 20);

struct FingerRecord {
  uint first;  // its smallest contact
  uint solid;
  uint contacts;
  uint point_like;
  uint id;     // stays the same while the finger is followed
  uint start;  // of its contacts among those in order of their fingers
  uint foci;
  uint placed;  // every focus has a place, that of an empty sector too
  vec4 centre;
  vec4 axis1;  // w: eigenvalue
  vec4 axis2;
  vec4 axis3;
  vec4 turn;      // cosine and sine of the angle from axis1 to the principal direction, towards axis2
  vec4 mean;      // the centroid relative to the first contact, to more digits than `centre` has
  vec4 lean;      // the contacts' covariance of depth with place, m^2: where they lie deeper
  uint held_low;  // a bit per focus: its sector is empty, but has not been so for long
  uint held_high;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(FingerRecord, 160);
PALPA_CHECK_OFFSET(FingerRecord, start, 20);
PALPA_CHECK_OFFSET(FingerRecord, centre, 32);
PALPA_CHECK_OFFSET(FingerRecord, axis3, 80);
PALPA_CHECK_OFFSET(FingerRecord, turn, 96);
PALPA_CHECK_OFFSET(FingerRecord, mean, 112);
PALPA_CHECK_OFFSET(FingerRecord, lean, 128);
PALPA_CHECK_OFFSET(FingerRecord, held_low, 144);

PALPA_SHADER_END
#endif
