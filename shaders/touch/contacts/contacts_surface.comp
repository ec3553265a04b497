#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/contacts/contacts_chunk.glsl"
#include "shaders/shared/scan.h"
#include "shaders/touch/contacts/surface_math.h"
#include "shaders/touch/contacts/reach.h"

// Like contacts_find, for scenes with a solid that is tested by its surface or by its parts. Each thread looks up its
// points by itself: consecutive points lie side by side on the skin, so their cells and lists are much alike.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool one_solid = false;
layout(constant_id = 1) const bool with_deep = false;
layout(constant_id = 2) const bool with_parts = false;

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
layout(set = 0, binding = 10) uniform usamplerBuffer surface_cells;
layout(set = 0, binding = 11) uniform usamplerBuffer surface_runs;
layout(set = 0, binding = 12) uniform samplerBuffer surface_triangles;
layout(set = 0, binding = 13) uniform usamplerBuffer surface_signs;
layout(set = 0, binding = 14) uniform samplerBuffer surface_corners;
layout(set = 0, binding = 15) uniform usamplerBuffer parts_words;
layout(std430, set = 0, binding = 16) readonly buffer Reach { ReachTable reach; };
layout(push_constant) uniform Push { ContactsPush push; };

#include "shaders/touch/contacts/contacts_math.h"
#define PALPA_PARTS_WORD(i) texelFetch(parts_words, int(i))
#include "shaders/touch/contacts/parts_depth.h"
#include "shaders/touch/contacts/surface_query.glsl"

float look(SolidRecord solid, Float3 p, float delta, out bool shell) {
  float depth;
  if (with_parts && solid.asked_by == asked_by_parts) {
    const uint cell = cell_of(p, solid.low, solid.cells_per_metre, solid.cells_per_axis);
    depth = parts_depth(solid.first_cell, cell, p, with_deep ? 3.0e38 : delta);
  } else if (one_solid || solid.asked_by == asked_by_surface) {  // a single convex solid uses contacts_find
    const SurfaceCell cell = surface_cell(vec3(p.x, p.y, p.z), solid.low.xyz, solid.cells_per_metre.x,
                                          solid.cells_per_axis, solid.first_cell);
    return surface_depth(cell, p, delta, shell);
  } else {
    const uint cell = cell_of(p, solid.low, solid.cells_per_metre, solid.cells_per_axis);
    depth = plane_cell_depth(solid.first_cell + cell, p, delta, with_deep);
  }
  shell = depth < delta;
  return depth;
}

#include "shaders/touch/contacts/contacts_walk.glsl"

void main() {
  walk();
}
