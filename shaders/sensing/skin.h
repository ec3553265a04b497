// Shared by engine/sensing/skin_pass.cpp, shaders/sensing/skin_count.comp and shaders/sensing/skin_scatter.comp.
#ifndef PALPA_SHADERS_SKIN_H
#define PALPA_SHADERS_SKIN_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// A block is 8 pixels of one row: one 16-byte load of depths. One invocation looks at a run of 4 consecutive blocks of
// its crop (row after row), a group at 64 runs.
PALPA_CONST skin_group = 64u;
PALPA_CONST skin_run_blocks = 4u;

// Contents of the buffers of both shaders, beside structs:
//   depth   uvec4[]: blocks of 8 raw depths, two per word, the even pixel in the low half
//   rays    vec2[]: normalised coordinates, one per pixel of the padded arrangement
// counts  uint[]: survivors per group; after the scan, those of the groups before it
//   points  vec4[]: world position, uintBitsToFloat(index)

// Specialization constant 0 of both. 1: rays come from the table. 0: the camera neither distorts nor ignores pixels,
// and ((u - cx) / fx, (v - cy) / fy) is cheaper than two loads.
PALPA_CONST skin_rays_from_table = 0u;

// The result of skin_count for skin_scatter.
struct SkinRun {
  uint survivors;  // one bit per pixel of the run
  uint before;     // survivors of the earlier runs of the group
};
PALPA_CHECK_SIZE(SkinRun, 8);

// One camera's crop.
struct SkinPush {
  vec4 pose_x;  // rows of T_world_camera
  vec4 pose_y;
  vec4 pose_z;
  vec4 box_low;      // xyz world; w: depth unit, metres
  vec4 box_high;     // xyz world; w: step between the pixels of a row, and between rows, that are looked at, 1 or more
  vec4 pinhole;      // cx, cy, 1 / fx, 1 / fy
  uint first_block;  // of the camera, in the common arrangement
  uint corner;       // the crop's first column (low half) and row (high half)
  uint row_blocks;   // blocks per row of the crop (low half) and of the image (high half)
  uint blocks;       // of the crop
  uint depth_range;  // lowest (low half) and highest raw depth that can lie in the box; the lowest is at least 1
  uint first_group;  // of the crop, in `counts`
  uint first_index;  // of the camera's first pixel
  uint width;        // of the image: index step from row to row
};
PALPA_CHECK_SIZE(SkinPush, 128);
PALPA_CHECK_OFFSET(SkinPush, box_low, 48);
PALPA_CHECK_OFFSET(SkinPush, first_block, 96);
PALPA_CHECK_OFFSET(SkinPush, width, 124);

PALPA_SHADER_END
#endif
