// Shared by engine/touch/bridge/bridge_pass.cpp and shaders/touch/bridge/bridge_*.comp.
#ifndef PALPA_SHADERS_BRIDGE_H
#define PALPA_SHADERS_BRIDGE_H
#include "shaders/shared/shared.h"

// A constant of the rules, or what is compared with it. tests/tools/split_sensitivity.cpp scales it by its name.
#ifndef PALPA_TUNED
#define PALPA_TUNED(name, value) value
#endif

PALPA_SHADER_BEGIN

PALPA_CONST bridge_group = 64u;
PALPA_CONST bridge_fingers = 64u;  // as fingers_most
// Number of values of the hash of contact numbers. For each value, one contact of a finger is a sample for all others.
PALPA_CONST bridge_samples = 64u;
PALPA_CONST bridge_sample_shift = 26u;
// An invertible hash: contact = hash * inverse, modulo 2^32.
PALPA_CONST bridge_hash = 0x9e3779b1u;
PALPA_CONST bridge_unhash = 0x0e8b2f51u;

// Contents of the buffers, beside structs:
//   parents  uint[]: per contact a number unique to its cluster
//   depth    uint[]: raw depths, two per word, the even pixel in the low half
//   rays     vec2[]: normalised coordinates per pixel of the padded arrangement
//   samples  BridgeSample[bridge_fingers * bridge_samples]
//   patches  BridgePatch[bridge_fingers]
//   pairs    BridgePair[bridge_fingers * bridge_fingers]: a before b only
// In the TouchHeader, bridge_join writes fingers, clusters and the dispatch of bridge_relabel.

struct BridgePush {
  uint most_contacts;
  uint cameras;
  float finger_width;  // metres; 0: nothing is joined
  uint elapsed_us;     // from the frame before, or known_restart
  uint rules;          // of known fingers
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(BridgePush, 32);
PALPA_CHECK_OFFSET(BridgePush, finger_width, 8);
PALPA_CHECK_OFFSET(BridgePush, rules, 16);

// A camera with the data to use its picture in both directions: pixel to point and point to pixel.
struct BridgeCamera {
  vec4 pose_x;  // rows of T_world_camera
  vec4 pose_y;
  vec4 pose_z;
  vec4 view_x;  // rows of T_camera_world
  vec4 view_y;
  vec4 view_z;
  vec4 lens;        // fx, fy, cx, cy
  vec4 distortion;  // k1, k2, p1, p2
  float k3;
  float reach;       // the square of the longest ray of the picture: beyond it the lens model may fold back
  float depth_unit;  // metres
  uint first_depth;  // raw depths below are no data
  uint width;
  uint height;
  uint pitch;        // pixels from row to row of the padded arrangement
  uint first_pixel;  // of the padded arrangement
  uint first_index;  // of the camera's skin points
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(BridgeCamera, 176);
PALPA_CHECK_OFFSET(BridgeCamera, view_x, 48);
PALPA_CHECK_OFFSET(BridgeCamera, lens, 96);
PALPA_CHECK_OFFSET(BridgeCamera, k3, 128);
PALPA_CHECK_OFFSET(BridgeCamera, width, 144);
PALPA_CHECK_OFFSET(BridgeCamera, first_index, 160);

// A contact and the outward normal of the skin there.
struct BridgeSample {
  float x;
  float y;
  float z;
  float normal_x;
  float normal_y;
  float normal_z;
  uint known;  // only for splitting: the finger of the frame before that it belongs to, or known_none
  uint unused0;
};
PALPA_CHECK_SIZE(BridgeSample, 32);
PALPA_CHECK_OFFSET(BridgeSample, normal_x, 12);

// A finger as FingersPass leaves it, which may be one patch of several.
struct BridgePatch {
  vec4 low;  // box and mean of its samples
  vec4 high;
  vec4 mean;
  uint samples;
  uint known;  // the finger of the frame before that most samples belong to, or known_none
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(BridgePatch, 64);
PALPA_CHECK_OFFSET(BridgePatch, mean, 32);
PALPA_CHECK_OFFSET(BridgePatch, samples, 48);

// The relation between two patches.
PALPA_CONST bridge_unknown = 0u;  // nothing shows that they are one finger
PALPA_CONST bridge_one = 1u;      // patches of one finger
PALPA_CONST bridge_two = 2u;      // of two fingers, whatever a third patch shows
struct BridgePair {
  uint kind;
  float facing;  // the smaller, the more certain: see facing_away
};
PALPA_CHECK_SIZE(BridgePair, 8);

PALPA_SHADER_END
#endif
