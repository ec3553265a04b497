#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/contacts/contacts_chunk.glsl"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/reach.h"

// Eq. (1) for every skin point: inside all planes of a solid, and less than delta below the nearest. The results are a
// bit per point, solid and depth of the contacts, and each chunk's count. This is for scenes of convex solids;
// contacts_surface.comp is for any scene.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool one_solid = false;
layout(constant_id = 1) const bool with_deep = false;

layout(std430, set = 0, binding = 0) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = 1) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = 2) writeonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Masks { uint masks[]; };
layout(std430, set = 0, binding = 4) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = 5) readonly buffer Solids { SolidRecord solids[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cells { PlaneCell cells[]; };
layout(std430, set = 0, binding = 7) readonly buffer Planes { vec4 planes[]; };
layout(std430, set = 0, binding = 8) writeonly buffer DeepMasks { uint deep_masks[]; };
layout(std430, set = 0, binding = 9) writeonly buffer DeepCounts { uint deep_counts[]; };
layout(std430, set = 0, binding = 10) readonly buffer Reach { ReachTable reach; };
layout(push_constant) uniform Push { ContactsPush push; };

#include "shaders/touch/contacts/contacts_math.h"

float look(SolidRecord solid, Float3 p, float delta, out bool shell) {
  const uint cell = cell_of(p, solid.low, solid.cells_per_metre, solid.cells_per_axis);
  const float depth = plane_cell_depth(solid.first_cell + cell, p, delta, with_deep);
  shell = depth < delta;
  return depth;
}

#include "shaders/touch/contacts/contacts_walk.glsl"

void main() {
  walk();
}
