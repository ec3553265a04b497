// Shared by engine/touch/fingers.cpp and shaders/fingers_*.comp.
#ifndef PALPA_SHADERS_FINGERS_H
#define PALPA_SHADERS_FINGERS_H
#include "shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST fingers_group = 64u;         // one thread per contact
PALPA_CONST fingers_select_group = 256u;  // a single group
PALPA_CONST fingers_most = 64u;
PALPA_CONST fingers_nothing = 0xffffffffu;

// Cells have this side, in finger gaps. Anything up to 1/sqrt(3) = 0.577 keeps two contacts of one cell within the gap,
// anything above 0.5 keeps contacts three cells apart beyond it; 0.55 leaves room for rounding on both sides, up to
// fingers_most_cells cells from a solid's centre.
PALPA_CONST fingers_most_cells = 100000u;

// Neighbours of a cell within two cells, each pair from one side only: the near ones touch it.
PALPA_CONST fingers_near = 13u;
PALPA_CONST fingers_neighbours = 62u;

// Bindings, the same numbers in all shaders that use them.
PALPA_CONST fingers_total = 0u;     // ScanTotal of the contacts
PALPA_CONST fingers_nodes = 1u;     // Node[]: per contact
PALPA_CONST fingers_cells = 2u;     // CellKey[]: per contact
PALPA_CONST fingers_parents = 3u;   // uint[]: per contact; at the end its cluster's smallest contact
PALPA_CONST fingers_places = 4u;    // Place[]: per contact
PALPA_CONST fingers_slots = 5u;     // Slot[]: the hash table, see table_slots
PALPA_CONST fingers_sizes = 6u;     // uint[]: per contact: contacts of the cluster it is the smallest of, else 0
PALPA_CONST fingers_contacts = 7u;  // ContactRecord[]
PALPA_CONST fingers_solids = 8u;    // SolidRecord[] (prepare only)
PALPA_CONST fingers_prepare_buffers = 9u;
PALPA_CONST fingers_insert_buffers = 6u;
PALPA_CONST fingers_link_buffers = 6u;
PALPA_CONST fingers_label_buffers = 7u;
// fingers_select has its own:
PALPA_CONST select_total = 0u;
PALPA_CONST select_length = 1u;    // ScanTotal of the skin points
PALPA_CONST select_sizes = 2u;
PALPA_CONST select_contacts = 3u;
PALPA_CONST select_header = 4u;    // TouchHeader
PALPA_CONST select_fingers = 5u;   // FingerRecord[fingers_most]
PALPA_CONST fingers_select_buffers = 6u;

struct FingersPush {
  float cells_per_metre;
  float limit;  // the gap's square
  uint most_contacts;
  uint first_neighbour;
  uint end_neighbour;
  uint min_points;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(FingersPush, 32);
PALPA_CHECK_OFFSET(FingersPush, most_contacts, 8);
PALPA_CHECK_OFFSET(FingersPush, min_points, 20);

// A contact in its cell's list.
struct Node {
  float x;
  float y;
  float z;
  uint next;
};
PALPA_CHECK_SIZE(Node, 16);
PALPA_CHECK_OFFSET(Node, next, 12);

struct CellKey {
  int x;
  int y;
  int z;
  uint solid;
};
PALPA_CHECK_SIZE(CellKey, 16);
PALPA_CHECK_OFFSET(CellKey, solid, 12);

struct Place {
  uint slot;
  uint rank;  // any order, but each of 0 .. count - 1 once
};
PALPA_CHECK_SIZE(Place, 8);

// A cell that holds contacts.
struct Slot {
  uint owner;  // some contact of the cell
  uint first;  // its smallest contact: the cell's node in the union-find
  uint count;
  uint head;   // of its list
};
PALPA_CHECK_SIZE(Slot, 16);
PALPA_CHECK_OFFSET(Slot, first, 4);
PALPA_CHECK_OFFSET(Slot, head, 12);

// What the host reads first; its first three words dispatch one group per finger.
struct TouchHeader {
  uint fingers;
  uint groups_y;
  uint groups_z;
  uint clusters;
  uint contacts;
  uint points;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(TouchHeader, 32);
PALPA_CHECK_OFFSET(TouchHeader, clusters, 12);
PALPA_CHECK_OFFSET(TouchHeader, points, 20);

struct FingerRecord {
  uint first;  // its smallest contact
  uint solid;
  uint contacts;
  uint point_like;
  vec4 centre;
  vec4 axis1;  // w: eigenvalue
  vec4 axis2;
  vec4 axis3;
};
PALPA_CHECK_SIZE(FingerRecord, 80);
PALPA_CHECK_OFFSET(FingerRecord, centre, 16);
PALPA_CHECK_OFFSET(FingerRecord, axis3, 64);

#ifdef __cplusplus
inline constexpr float fingers_cell_side = 0.55F;
#endif

PALPA_SHADER_END
#endif
