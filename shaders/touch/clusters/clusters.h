// Shared by engine/touch/points/clusters_pass.cpp and shaders/touch/clusters/clusters_*.comp.
#ifndef PALPA_SHADERS_CLUSTERS_H
#define PALPA_SHADERS_CLUSTERS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST clusters_select_group = 256u;  // a single group
PALPA_CONST clusters_most_selected = 64u;
PALPA_CONST clusters_nothing = 0xffffffffu;

// The side of a cell, in thousandths of the finger gap. Up to 1/sqrt(3) = 0.577, two contacts of one cell are always
// within the gap. Above 0.5, contacts three cells apart are always beyond it. 0.52 leaves room for rounding on both
// sides, up to clusters_most_blocks blocks from a solid's centre. A block is 2x2x2 cells: contacts of blocks that do
// not touch are beyond the gap. A tile is 2x2x2 blocks. Both are numbered along x, then y, then z.
PALPA_CONST clusters_cell_thousandths = 520u;
PALPA_CONST clusters_most_blocks = 30000u;

PALPA_CONST collect_run = 32u;  // slots of the hash table that a thread of clusters_collect looks at in one go

// Threads of a group in the passes over blocks.
PALPA_CONST blocks_group = 64u;
PALPA_CONST blocks_most_groups = 256u;
PALPA_CONST rest_most_groups = 16384u;
// Tests of two blocks before their groups of cells that are still apart go on the list of crowded pairs.
PALPA_CONST clusters_patience = 32u;
// Capacity of that list. If it or the list of blocks that touch (links_room() in clusters_math.h) is full, a pass tests
// everything again, pair by pair: this is slow, but just as exact.
PALPA_CONST clusters_crowded_per_contact = 1u;
// A software device ends all loops of a shader after 65,535 iterations together, and the result is then undefined. So a
// thread looks at few pairs of contacts and lists those that it could not decide. For each listed pair of groups, the
// contacts of the first group are shared out among clusters_undecided_parts groups of blocks_group threads. That is
// enough for 20,000 contacts in each of the two.
PALPA_CONST clusters_rest_patience = 2048u;
PALPA_CONST clusters_undecided_parts = 16u;

// Contents of the buffers, beside structs. A shader reads as texels what it only reads, see engine/gpu/texel_view.hpp.
//   nodes            uvec4[]: bits of x, y, z and the next entry in the cell's list: the first entry of a cell has the
//                    number of the cell, the others have the number of their contact plus most_contacts
//   tiles            uvec4[]: hash table: a TileKey, see clusters_table.glsl, and 64 cells as bits
//   bases            uint[]: per slot, its first cell's number
//   places           uint[]: per contact, its slot times 64, plus its cell there, or clusters_first
//   list             uint[]: the blocks that hold contacts: slot times 8, plus the block there
//   links            uvec2[]: two blocks that touch, see clusters_links.glsl
//   groups_of_block  uint[]: at a block's first cell's number, see clusters_cells.glsl
//   crowded          CrowdedPair[]
//   undecided        CrowdedPair[]: the pairs that stayed undecided
//   left             output list of clusters_link: bound to `crowded` or `undecided`
//   forest           uint[]: union-find over cells
//   seen             the forest as texels: may be out of date while others write it
//   large            uint[]: roots of clusters that may be fingers, in any order
//   parents          uint[]: per contact, its cell's number; at the end, the number of its root
//   clusters         Cluster[]: per root
//   selected         ClusterRecord[]: the clusters that may be fingers, in the order of their smallest contacts
//   inside           ContactRecord[]: the contacts, then the deep points
PALPA_CONST clusters_first = 0x80000000u;  // of its cell
PALPA_CONST clusters_solid_texels = 6u;
PALPA_CONST clusters_centre_texel = 1u;

struct GatherPush {
  uint most_contacts;
  uint most_deep;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(GatherPush, 16);
PALPA_CHECK_OFFSET(GatherPush, most_deep, 4);

struct ClustersPush {
  float cells_per_metre;
  float limit;  // the square of the gap
  uint most_contacts;
  uint min_points;
};
PALPA_CHECK_SIZE(ClustersPush, 16);
PALPA_CHECK_OFFSET(ClustersPush, most_contacts, 8);
PALPA_CHECK_OFFSET(ClustersPush, min_points, 12);

// Two groups of cells with many contacts each. For both: their block's first cell; its cells that hold contacts as
// bits, plus 256 times those of the group.
struct CrowdedPair {
  uint first_a;
  uint first_b;
  uint cells_a;
  uint cells_b;
};
PALPA_CHECK_SIZE(CrowdedPair, 16);
PALPA_CHECK_OFFSET(CrowdedPair, cells_a, 8);

// The amount of work, and the indirect dispatches that do it.
struct ClustersWork {
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
  uint rest_x;  // 0 unless the list of links or of crowded pairs was full
  uint rest_y;
  uint rest_z;
  uint large;  // clusters that may be fingers
};
PALPA_CHECK_SIZE(ClustersWork, 96);
PALPA_CHECK_OFFSET(ClustersWork, cells, 12);
PALPA_CHECK_OFFSET(ClustersWork, blocks, 28);
PALPA_CHECK_OFFSET(ClustersWork, links_x, 32);
PALPA_CHECK_OFFSET(ClustersWork, links, 44);
PALPA_CHECK_OFFSET(ClustersWork, crowded_x, 48);
PALPA_CHECK_OFFSET(ClustersWork, crowded, 60);
PALPA_CHECK_OFFSET(ClustersWork, undecided_x, 64);
PALPA_CHECK_OFFSET(ClustersWork, undecided, 76);
PALPA_CHECK_OFFSET(ClustersWork, rest_x, 80);
PALPA_CHECK_OFFSET(ClustersWork, large, 92);

struct Cluster {
  uint smallest;  // contact
  uint size;
};
PALPA_CHECK_SIZE(Cluster, 8);

// What the host reads: how many of everything there are, and the clusters that may be fingers.
struct TouchHeader {
  uint selected;  // of these clusters: at most clusters_most_selected
  uint clusters;
  uint contacts;
  uint points;
};
PALPA_CHECK_SIZE(TouchHeader, 16);
PALPA_CHECK_OFFSET(TouchHeader, contacts, 8);

struct ClusterRecord {
  uint first;  // its smallest contact
  uint solid;
  uint contacts;
  uint unused0;
};
PALPA_CHECK_SIZE(ClusterRecord, 16);
PALPA_CHECK_OFFSET(ClusterRecord, contacts, 8);

PALPA_SHADER_END
#endif
