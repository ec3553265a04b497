// Shared by engine/gpu/scan_pass.cpp and shaders/shared/scan.comp.
#ifndef PALPA_SHADERS_SCAN_H
#define PALPA_SHADERS_SCAN_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST scan_group = 256u;

// How an indirect dispatch over items is cut into groups of `size` items each. There are at least `least` and at most
// `most` groups. The number of groups, `least` and `most` are all multiples of `step`.
struct ScanGroups {
  uint size;
  uint least;
  uint most;
  uint step;
};
PALPA_CHECK_SIZE(ScanGroups, 16);

PALPA_FN uint scan_groups_of(uint items, ScanGroups cut) {
  const uint asked = items / cut.size + (items % cut.size == 0u ? 0u : 1u);
  const uint whole = (asked + cut.step - 1u) / cut.step * cut.step;
  const uint enough = whole < cut.least ? cut.least : whole;
  return enough < cut.most ? enough : cut.most;
}

struct ScanPush {
  uint counts;
  uint most_total;
  ScanGroups groups;
};
PALPA_CHECK_SIZE(ScanPush, 24);
PALPA_CHECK_OFFSET(ScanPush, groups, 8);

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
