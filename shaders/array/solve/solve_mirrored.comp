#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#define SOLVE_MIRRORED
#include "shaders/array/solve/solve_matrix.glsl"

layout(local_size_x = 32) in;

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  // Pair number of (row, column) with row < column: column (column - 1) / 2 + row.
  uint column_tile = 1u;
  uint row_tile = gl_WorkGroupID.y;
  for (uint c = 1u; c < solve_most_foci && row_tile >= column_tile; ++c) {
    row_tile -= column_tile;
    ++column_tile;
  }
  if (column_tile * tile >= slot.count) return;
  fill_tile(slot, row_tile, column_tile);
}
