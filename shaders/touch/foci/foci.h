// Shared by engine/touch/foci/foci_pass.cpp and shaders/touch/foci/foci.comp.
#ifndef PALPA_SHADERS_FOCI_H
#define PALPA_SHADERS_FOCI_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// One group per finger.
PALPA_CONST foci_group = 128u;
PALPA_CONST foci_most = 64u;

PALPA_CONST spacing_angle = 0u;
PALPA_CONST spacing_arc = 1u;
// Number of corners of the outline of a cross-section, at equal angles.
PALPA_CONST outline_bins = 64u;

// Contents of the buffers, beside the fingers, whose `foci` is written:
//   grouped   uvec4[]: as the sections pass leaves it; read as texels
//   foci      FocusRecord[finger * foci_most + n]
//   borders   Border[]: for N foci, the directions 2 pi n / N from N (N - 1) / 2 on
//   of_solid  uint[]: N of each solid's fingers, or 0 for the push constant's value

struct FociPush {
  uint foci;
  uint spacing;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(FociPush, 16);
PALPA_CHECK_OFFSET(FociPush, spacing, 4);

struct FocusRecord {
  float x;
  float y;
  float z;
  uint points;
};
PALPA_CHECK_SIZE(FocusRecord, 16);
PALPA_CHECK_OFFSET(FocusRecord, points, 12);

struct Border {
  float x;
  float y;
};
PALPA_CHECK_SIZE(Border, 8);

PALPA_SHADER_END
#endif
