// Shared by engine/touch/sections.cpp and shaders/sections.comp.
#ifndef PALPA_SHADERS_SECTIONS_H
#define PALPA_SHADERS_SECTIONS_H
#include "shared.h"
PALPA_SHADER_BEGIN

// One group per finger; contact i belongs to thread i mod sections_group.
PALPA_CONST sections_group = 128u;
PALPA_CONST sections_most_foci = 64u;

// Bindings.
PALPA_CONST sections_total = 0u;     // ScanTotal of the contacts
PALPA_CONST sections_parents = 1u;   // uint[]: per contact its cluster's root
PALPA_CONST sections_contacts = 2u;  // ContactRecord[]: `finger` is written
PALPA_CONST sections_fingers = 3u;   // FingerRecord[]
PALPA_CONST sections_foci = 4u;      // FocusRecord[finger * sections_most_foci + n]
PALPA_CONST sections_borders = 5u;   // Border[]: for N foci the directions 2 pi n / N from N (N - 1) / 2 on
PALPA_CONST sections_buffers = 6u;

struct SectionsPush {
  uint most_contacts;
  uint foci;
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(SectionsPush, 16);
PALPA_CHECK_OFFSET(SectionsPush, foci, 4);

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
