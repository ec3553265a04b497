// Shared by engine/touch/split/split_pass.cpp and shaders/touch/split/split_*.comp.
#ifndef PALPA_SHADERS_SPLIT_H
#define PALPA_SHADERS_SPLIT_H
#include "shaders/shared/shared.h"
#include "shaders/touch/bridge/bridge.h"
PALPA_SHADER_BEGIN

PALPA_CONST split_group = 64u;  // a thread per sample of a finger, or per finger
PALPA_CONST split_looks = 4u;   // groups of split_look for each finger
// A walk from contact to contact looks at no more pixels than this.
PALPA_CONST split_steps = 64u;
// Parts of fingers have numbers beyond those of clusters, this many for each finger.
PALPA_CONST split_numbers = 64u;

// Contents of the buffers, beside structs:
//   parents   uint[]: per contact a number unique to its cluster
//   depth     uint[]: raw depths, two per word, the even pixel in the low half
//   rays      vec2[]: normalised coordinates per pixel of the padded arrangement
//   samples   BridgeSample[bridge_fingers * bridge_samples]
//   states    SplitState[bridge_fingers]
//   shown     SplitEvidence[bridge_fingers * bridge_samples]: split_sample leaves it empty for wide fingers
//   labels    uint[bridge_fingers * bridge_samples]: a sample's part: its first sample
//   clusters  Cluster[]: split_parts makes those of the parts empty
// In the TouchHeader, split_sample writes the dispatches of the others.

struct SplitPush {
  uint most_contacts;
  uint cameras;
  float finger_width;  // metres; 0: nothing is split
  uint min_points;
  uint elapsed_us;  // from the frame before, or known_restart
  uint rules;       // of known fingers
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(SplitPush, 32);
PALPA_CHECK_OFFSET(SplitPush, rules, 20);
PALPA_CHECK_OFFSET(SplitPush, finger_width, 8);

// For a sample: the other samples for which a camera that sees both gives any evidence, and those with a valley in
// between.
struct SplitEvidence {
  uint looked_low;
  uint looked_high;
  uint valley_low;
  uint valley_high;
};
PALPA_CHECK_SIZE(SplitEvidence, 16);
PALPA_CHECK_OFFSET(SplitEvidence, valley_low, 8);

// What happens to a finger as FingersPass leaves it.
PALPA_CONST split_stays = 0u;
PALPA_CONST split_wide = 1u;
PALPA_CONST split_several = 2u;  // it is split
PALPA_CONST split_ghost = 3u;    // no surface supports it
struct SplitState {
  uint kind;
  uint samples;
  uint parts_low;  // for split_several, a bit per part's number
  uint parts_high;
  uint root;       // of its contacts, as FingersPass leaves it
  uint known_low;  // the parts that are fingers of the frame before
  uint known_high;
  uint unused0;
};
PALPA_CHECK_SIZE(SplitState, 32);
PALPA_CHECK_OFFSET(SplitState, root, 16);

PALPA_SHADER_END
#endif
