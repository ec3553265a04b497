#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "contacts_chunk.glsl"
#include "scan.h"
#include "touch_math.h"

// Eq. (1) for every skin point: inside all planes of a solid, and less than delta below the nearest. Leaves a bit per point,
// solid and depth of the contacts, and each chunk's count. For scenes of convex solids; contacts_surface.comp is for any.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool one_solid = false;
layout(constant_id = 1) const bool with_deep = false;

layout(std430, set = 0, binding = contacts_points) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = contacts_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = contacts_hits) writeonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = contacts_masks) writeonly buffer Masks { uint masks[]; };
layout(std430, set = 0, binding = contacts_counts) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = contacts_solids) readonly buffer Solids { SolidRecord solids[]; };
layout(std430, set = 0, binding = contacts_cells) readonly buffer Cells { PlaneCell cells[]; };
layout(std430, set = 0, binding = contacts_planes) readonly buffer Planes { vec4 planes[]; };
layout(std430, set = 0, binding = contacts_deep_masks) writeonly buffer DeepMasks { uint deep_masks[]; };
layout(std430, set = 0, binding = contacts_deep_counts) writeonly buffer DeepCounts { uint deep_counts[]; };
layout(push_constant) uniform Push { ContactsPush push; };

#include "contacts_planes.glsl"

shared uint found[contacts_most_words];
shared uint deep_found[contacts_most_words];
shared uint sum, deep_sum;

float delta_of(float own) {
  return own > 0.0 ? own : push.delta;
}

// The first solid that the point is a contact of, with its depth; where there is none and deep points are asked for, the first
// that it is deep inside of. Depth 0: neither.
Hit find(vec3 point, out bool deep) {
  deep = false;
  if (one_solid) {
    const SolidRecord solid = push.only;
    const vec3 p = in_solid(point, solid.centre, solid.low.w, solid.high.w, solid.cells_per_metre.w);
    if (!in_box(p, solid.low.xyz, solid.high.xyz)) return Hit(0u, 0.0);
    const float delta = delta_of(solid.delta);
    const float depth = plane_cell_depth(p, solid.low.xyz, solid.cells_per_metre.xyz, solid.cells_per_axis, 0u, delta, with_deep);
    deep = depth >= delta;
    return Hit(0u, deep && !with_deep ? 0.0 : depth);
  }
  Hit hit = Hit(0u, 0.0);
  for (uint s = 0u; s < push.solids && (hit.depth == 0.0 || deep); ++s) {
    const SolidRecord solid = solids[s];
    const vec3 p = in_solid(point, solid.centre, solid.low.w, solid.high.w, solid.cells_per_metre.w);
    if (!in_box(p, solid.low.xyz, solid.high.xyz)) continue;
    const float delta = delta_of(solid.delta);
    const float depth =
        plane_cell_depth(p, solid.low.xyz, solid.cells_per_metre.xyz, solid.cells_per_axis, solid.first_cell, delta, with_deep);
    if (depth == 0.0 || (depth >= delta && (!with_deep || deep))) continue;
    deep = depth >= delta;
    hit = Hit(s, depth);
  }
  return hit;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(given.total, push.most_points);
  const uint chunk = points_per_chunk(count);
  const uint first = gl_WorkGroupID.x * chunk;
  const uint last = min(first + chunk, count);
  if (first >= count) {  // the whole group
    if (thread == 0u) {
      counts[gl_WorkGroupID.x] = 0u;
      if (with_deep) deep_counts[gl_WorkGroupID.x] = 0u;
    }
    return;
  }
  const uint words = chunk / 32u;
  for (uint w = thread; w < words; w += contacts_group) {
    found[w] = 0u;
    if (with_deep) deep_found[w] = 0u;
  }
  if (thread == 0u) {
    sum = 0u;
    deep_sum = 0u;
  }
  barrier();

  for (uint i = first + thread; i < last; i += contacts_group) {
    const vec3 point = uintBitsToFloat(points[i].xyz);
    if (!is_finite(point.x) || !is_finite(point.y) || !is_finite(point.z)) continue;
    bool deep;
    const Hit hit = find(point, deep);
    if (hit.depth == 0.0) continue;
    hits[i] = hit;
    if (with_deep && deep) {
      atomicOr(deep_found[(i - first) >> 5u], 1u << (i & 31u));
    } else {
      atomicOr(found[(i - first) >> 5u], 1u << (i & 31u));
    }
  }
  barrier();

  uint mine = 0u;
  uint mine_deep = 0u;
  for (uint w = thread; w < words; w += contacts_group) {
    masks[first / 32u + w] = found[w];
    mine += uint(bitCount(found[w]));
    if (with_deep) {
      deep_masks[first / 32u + w] = deep_found[w];
      mine_deep += uint(bitCount(deep_found[w]));
    }
  }
  if (mine != 0u) atomicAdd(sum, mine);
  if (mine_deep != 0u) atomicAdd(deep_sum, mine_deep);
  barrier();
  if (thread == 0u) {
    counts[gl_WorkGroupID.x] = sum;
    if (with_deep) deep_counts[gl_WorkGroupID.x] = deep_sum;
  }
}
