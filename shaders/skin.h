// Shared by engine/sensing/skin.cpp, shaders/skin_count.comp and shaders/skin_scatter.comp.
#ifndef PALPA_SHADERS_SKIN_H
#define PALPA_SHADERS_SKIN_H
#include "shared.h"
PALPA_SHADER_BEGIN

// One invocation looks at one block of 8 pixels of a row; a group at 64 blocks in a row's order.
PALPA_CONST skin_group = 64u;

// Bindings of both shaders.
PALPA_CONST skin_depth = 0u;   // uvec4[]: blocks of 8 raw depths, two per word, the even pixel in the low half
PALPA_CONST skin_rays = 1u;    // vec2[]: normalised coordinates, one per pixel of the padded arrangement
PALPA_CONST skin_blocks = 2u;  // uint[]: per block, bits 0..7: which pixels survive, bits 8..: survivors before it in its group
PALPA_CONST skin_counts = 3u;  // uint[]: survivors per group, after the scan those before it
PALPA_CONST skin_points = 4u;  // vec4[]: world position, uintBitsToFloat(index); skin_scatter only
PALPA_CONST skin_count_buffers = 4u;
PALPA_CONST skin_scatter_buffers = 5u;

// One camera's view.
struct SkinPush {
  vec4 pose_x;  // rows of T_world_camera
  vec4 pose_y;
  vec4 pose_z;
  vec4 box_low;   // xyz world; w: depth unit, metres
  vec4 box_high;  // xyz world
  uint first_block;     // of the image arrangement, of the view's upper left block
  uint pitch_blocks;    // blocks from row to row
  uint blocks_per_row;  // of the view
  uint blocks;          // of the view
  uint depth_low;       // raw depths in [low, low + span] can lie in the box
  uint depth_span;
  uint first_group;     // of the view, in `counts`
  uint first_index;     // of the skin point of the view's upper left pixel
  uint width;           // of the image: index step from row to row
  uint most_points;     // room in `points`
  uint unused0;
  uint unused1;
};
PALPA_CHECK_SIZE(SkinPush, 128);
PALPA_CHECK_OFFSET(SkinPush, box_low, 48);
PALPA_CHECK_OFFSET(SkinPush, first_block, 80);
PALPA_CHECK_OFFSET(SkinPush, most_points, 116);

PALPA_SHADER_END
#endif
