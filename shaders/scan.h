// Shared by engine/gpu/scan_pass.cpp and shaders/scan.comp.
#ifndef PALPA_SHADERS_SCAN_H
#define PALPA_SHADERS_SCAN_H
#include "shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST scan_group = 256u;

// Bindings.
PALPA_CONST scan_counts = 0u;  // uint[]: in place
PALPA_CONST scan_length = 1u;  // uint[1]: items, where items_per_count > 0
PALPA_CONST scan_total = 2u;   // ScanTotal
PALPA_CONST scan_buffers = 3u;

struct ScanPush {
  uint most_counts;
  uint items_per_count;  // 0: exactly most_counts counts
  uint most_total;
  uint group_size;
};
PALPA_CHECK_SIZE(ScanPush, 16);

// The sum, then the arguments of an indirect dispatch over that many items.
struct ScanTotal {
  uint total;
  uint groups_x;
  uint groups_y;
  uint groups_z;
};
PALPA_CHECK_SIZE(ScanTotal, 16);
PALPA_CHECK_OFFSET(ScanTotal, groups_x, 4);

PALPA_SHADER_END
#endif
