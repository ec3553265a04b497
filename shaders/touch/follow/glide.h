// Shared by engine/touch/follow/glide_pass.cpp and shaders/touch/follow/glide.comp.
#ifndef PALPA_SHADERS_GLIDE_H
#define PALPA_SHADERS_GLIDE_H
#include "shaders/shared/shared.h"
#include "shaders/touch/foci/foci.h"
#include "shaders/touch/follow/follow.h"
PALPA_SHADER_BEGIN

// One group per finger, a thread per focus.
PALPA_CONST glide_group = 64u;

// A focus as it was played.
struct GlidingFocus {
  float x;  // world
  float y;
  float z;
  uint empty_us;  // time since its sector has had contacts
  float speed_x;  // m/s, smoothed: speed of its sector's target relative to the finger
  float speed_y;
  float speed_z;
  uint unused0;
};
PALPA_CHECK_SIZE(GlidingFocus, 32);
PALPA_CHECK_OFFSET(GlidingFocus, empty_us, 12);
PALPA_CHECK_OFFSET(GlidingFocus, speed_x, 16);

// The data kept of a finger's foci from frame to frame, at its track's home.
struct Home {
  vec4 centre;    // of the contacts when it was last seen
  vec4 velocity;  // m/s
  vec4 axis1;
  vec4 axis3;
  uint foci;
  uint unused0;
  uint unused1;
  uint unused2;
  GlidingFocus focus[foci_most];
};
PALPA_CHECK_SIZE(Home, 80 + 32 * 64);
PALPA_CHECK_OFFSET(Home, axis3, 48);
PALPA_CHECK_OFFSET(Home, foci, 64);
PALPA_CHECK_OFFSET(Home, focus, 80);

PALPA_SHADER_END
#endif
