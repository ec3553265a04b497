// Shared by engine/touch/split/split_pass.cpp and shaders/split_*.comp.
#ifndef PALPA_SHADERS_SPLIT_H
#define PALPA_SHADERS_SPLIT_H
#include "shaders/shared/shared.h"
#include "shaders/touch/bridge/bridge.h"
PALPA_SHADER_BEGIN

PALPA_CONST split_group = 64u;  // a thread per sample of a finger, or per finger
PALPA_CONST split_looks = 4u;   // groups of split_look for each finger
// A walk from contact to contact looks at no more pixels.
PALPA_CONST split_steps = 64u;
// Parts of fingers have numbers of their own beyond those of clusters, this many for each finger.
PALPA_CONST split_numbers = 64u;

// Bindings of split_sample.
PALPA_CONST split_sample_total = 0u;      // ScanTotal of the contacts
PALPA_CONST split_sample_parents = 1u;    // uint[]: per contact a number that its cluster alone has
PALPA_CONST split_sample_contacts = 2u;   // ContactRecord[]
PALPA_CONST split_sample_fingers = 3u;    // FingerRecord[]
PALPA_CONST split_sample_depth = 4u;      // uint[]: raw depths, two per word, the even pixel in the low half
PALPA_CONST split_sample_rays = 5u;       // vec2[]: normalised coordinates per pixel of the padded arrangement
PALPA_CONST split_sample_cameras = 6u;    // BridgeCamera[]
PALPA_CONST split_sample_out = 7u;        // BridgeSample[bridge_fingers * bridge_samples]
PALPA_CONST split_sample_states = 8u;     // SplitState[bridge_fingers]
PALPA_CONST split_sample_header = 9u;     // TouchHeader: dispatches of the others are written
PALPA_CONST split_sample_evidence = 10u;  // SplitEvidence[bridge_fingers * bridge_samples]: none yet, of wide fingers
PALPA_CONST split_sample_buffers = 11u;
// Bindings of split_look.
PALPA_CONST split_look_depth = 0u;
PALPA_CONST split_look_cameras = 1u;
PALPA_CONST split_look_samples = 2u;
PALPA_CONST split_look_states = 3u;
PALPA_CONST split_look_evidence = 4u;
PALPA_CONST split_look_buffers = 5u;
// Bindings of split_parts.
PALPA_CONST split_parts_evidence = 0u;
PALPA_CONST split_parts_samples = 1u;
PALPA_CONST split_parts_states = 2u;
PALPA_CONST split_parts_labels = 3u;    // uint[bridge_fingers * bridge_samples]: a sample's part: its first sample
PALPA_CONST split_parts_clusters = 4u;  // Cluster[]: those of the parts are made empty
PALPA_CONST split_parts_buffers = 5u;
// Bindings of split_assign.
PALPA_CONST split_assign_total = 0u;
PALPA_CONST split_assign_header = 1u;  // TouchHeader
PALPA_CONST split_assign_contacts = 2u;
PALPA_CONST split_assign_samples = 3u;
PALPA_CONST split_assign_states = 4u;
PALPA_CONST split_assign_labels = 5u;
PALPA_CONST split_assign_parents = 6u;
PALPA_CONST split_assign_clusters = 7u;
PALPA_CONST split_assign_buffers = 8u;
// Bindings of split_list.
PALPA_CONST split_list_header = 0u;
PALPA_CONST split_list_fingers = 1u;
PALPA_CONST split_list_states = 2u;
PALPA_CONST split_list_clusters = 3u;
PALPA_CONST split_list_buffers = 4u;

struct SplitPush {
  uint most_contacts;
  uint cameras;
  float finger_width;  // metres; 0: nothing is split
  uint min_points;
};
PALPA_CHECK_SIZE(SplitPush, 16);
PALPA_CHECK_OFFSET(SplitPush, finger_width, 8);

// Of a sample: the others of which a camera that sees both says anything, and those between which and it one sees a
// valley.
struct SplitEvidence {
  uint looked_low;
  uint looked_high;
  uint valley_low;
  uint valley_high;
};
PALPA_CHECK_SIZE(SplitEvidence, 16);
PALPA_CHECK_OFFSET(SplitEvidence, valley_low, 8);

// What becomes of a finger as FingersPass leaves it.
PALPA_CONST split_stays = 0u;
PALPA_CONST split_wide = 1u;
PALPA_CONST split_several = 2u;  // it is split
PALPA_CONST split_ghost = 3u;    // no surface supports it
struct SplitState {
  uint kind;
  uint samples;
  uint parts_low;  // of split_several, a bit per part's number
  uint parts_high;
  uint root;  // of its contacts, as FingersPass leaves it
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(SplitState, 32);
PALPA_CHECK_OFFSET(SplitState, root, 16);

PALPA_SHADER_END
#endif
