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
//   limits  uvec4[]: like depth, the largest raw depth that is nearer than the pixel's background
// counts  uint[]: survivors per group; after the scan, those of the groups before it
//   points  vec4[]: world position, uintBitsToFloat(index)
//   dropped uint[4]: the points inside the box that are no skin, by the reason below

// Specialization constant 0 of both. 1: rays come from the table. 0: the camera neither distorts nor ignores pixels,
// and ((u - cx) / fx, (v - cy) / fy) is cheaper than two loads.
PALPA_CONST skin_rays_from_table = 0u;
// Specialization constant 1 of skin_count, a sum of these: points in one of the volumes are dropped; points that are
// not nearer than the background are dropped. A kernel with neither does no work for them.
PALPA_CONST skin_drops_volumes = 1u;
PALPA_CONST skin_drops_background = 2u;

// Why a point is no skin, in the order in which it is looked for.
PALPA_CONST skin_room = 0u;
PALPA_CONST skin_board = 1u;
PALPA_CONST skin_screen = 2u;
PALPA_CONST skin_background = 3u;
PALPA_CONST skin_kept = 4u;  // it is skin

// How far before and behind its face a board or screen drops points, metres.
PALPA_CONST_FLOAT skin_before_m = 8e-3f;
PALPA_CONST_FLOAT skin_behind_m = 50e-3f;

// Where points are dropped. The room drops the points outside the box from x.xyz to y.xyz (world). Any other volume has
// the rows of T_volume_world in x, y, z, and drops the points over a rectangle in its plane z = 0.
struct SkinVolume {
  vec4 x;
  vec4 y;
  vec4 z;
  float half_width;
  float half_height;
  uint kind;
  uint unused;
};
PALPA_CHECK_SIZE(SkinVolume, 64);
PALPA_CHECK_OFFSET(SkinVolume, half_width, 48);
PALPA_CHECK_OFFSET(SkinVolume, kind, 56);

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
