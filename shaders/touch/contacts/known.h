// What contacts and fingers know of the fingers of the frame before. Kernels read the table up to its fingers.
#ifndef PALPA_SHADERS_KNOWN_H
#define PALPA_SHADERS_KNOWN_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST known_fingers = 64u;  // as fingers_most
PALPA_CONST known_samples = 64u;  // as bridge_samples
PALPA_CONST known_none = 0xffffffffu;
// As the time since the frame before: there are no known fingers.
PALPA_CONST known_restart = 0xffffffffu;

// The rules that are on, as bits.
PALPA_CONST known_few = 1u;       // a known finger needs half as many contacts, and half as many firm ones
PALPA_CONST known_islands = 2u;   // a small island waits: beside a known finger, or with few contacts
PALPA_CONST known_apart = 4u;     // known fingers stay apart
PALPA_CONST known_together = 8u;  // a known finger stays one
PALPA_CONST known_edges = 16u;    // contacts of a known finger that is about to end reach beyond the shell's edges
PALPA_CONST known_falling = 32u;  // known_few and known_edges do not hold a finger that leaves

// How a finger loses its contacts, see known_math.h.
struct Fall {
  uint contacts;  // in the shell
  uint from;      // before it began to lose them, frame after frame; 0: it does not lose them
  uint falls;     // 1: it leaves
};

// A finger of the frame before.
struct KnownFinger {
  uint solid;
  uint samples;
  uint unused0;
  uint parting_us;  // since it last looked like several fingers, or known_never
  vec4 velocity;    // of its track
  uint meeting_us;  // for how long it has looked like one with another
  Fall fall;
  vec4 centre;  // of its samples; w: the square of its reach around them, 0 if it does not reach beyond the edges
  vec4 inward;  // unit: the mean of its skin's outward normals, which point into the solid
};
PALPA_CHECK_SIZE(KnownFinger, 80);
PALPA_CHECK_OFFSET(KnownFinger, velocity, 16);
PALPA_CHECK_OFFSET(KnownFinger, meeting_us, 32);
PALPA_CONST known_never = 0xffffffffu;

// Bits of KnownTable::doubts: what this frame shows against what is known of a finger.
PALPA_CONST doubt_one = 1u;    // it looks like several fingers
PALPA_CONST doubt_apart = 2u;  // it looks like one with another

// A small cluster that is not a finger yet.
struct Island {
  float x;
  float y;
  float z;
  uint solid;
  uint age_us;
  uint unused0;
  uint unused1;
  uint unused2;
};
PALPA_CHECK_SIZE(Island, 32);
PALPA_CHECK_OFFSET(Island, age_us, 16);

struct KnownTable {
  uint count;
  uint islands;
  uint reaching;  // known fingers that reach beyond the shell's edges
  uint unused0;
  KnownFinger fingers[known_fingers];
  uint doubts[known_fingers];  // of the known fingers in this frame
  Island island[known_fingers];
  vec4 insides[known_fingers * known_samples];  // per finger and sample: the point inside the finger, see split_math.h
};
PALPA_CHECK_SIZE(KnownTable, 16 + 64 * 80 + 64 * 4 + 64 * 32 + 64 * 64 * 16);
PALPA_CHECK_OFFSET(KnownTable, fingers, 16);
PALPA_CHECK_OFFSET(KnownTable, insides, 16 + 64 * 116);

// What a finger of this frame has to do with those of the frame before.
struct Claim {
  uint known;  // the finger that most of its samples belong to, and at least half of them; or known_none
  uint near;   // the known finger of its solid that is nearest, within a finger width; or known_none
  uint contacts;
  uint parting_us;  // as of the known finger, after this frame
  uint meeting_us;
  uint samples;  // 0: its pixels give no normals
  Fall fall;     // of the known finger; zeros if there is none
};
PALPA_CHECK_SIZE(Claim, 36);

PALPA_SHADER_END
#endif
