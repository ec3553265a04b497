#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/array/solve/solve_matrix.glsl"

layout(local_size_x = 32) in;

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot) || gl_WorkGroupID.y * tile >= slot.count) return;
  fill_tile(slot, gl_WorkGroupID.y, gl_WorkGroupID.y);
}
