#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "contacts_chunk.glsl"
#include "scan.h"
#include "touch_math.h"

// Eq. (1) for every skin point: inside all planes of a solid, and less than delta below the nearest. Leaves a bit per point,
// solid and depth of the contacts, and each chunk's count.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool one_solid = false;

layout(std430, set = 0, binding = contacts_points) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = contacts_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = contacts_hits) writeonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = contacts_masks) writeonly buffer Masks { uint masks[]; };
layout(std430, set = 0, binding = contacts_counts) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = contacts_solids) readonly buffer Solids { SolidRecord solids[]; };
layout(std430, set = 0, binding = contacts_cells) readonly buffer Cells { PlaneCell cells[]; };
layout(std430, set = 0, binding = contacts_planes) readonly buffer Planes { vec4 planes[]; };
layout(push_constant) uniform Push { ContactsPush push; };

shared uint found[contacts_most_words];
shared uint sum;

bool inside(vec3 p, vec3 low, vec3 high) {
  return all(greaterThanEqual(p, low)) && all(lessThanEqual(p, high));
}

// Eq. (1)'s depth below the nearest plane if it is in (0, delta), else 0. `p` is relative to the solid's centre.
float shell_depth(vec3 p, vec3 low, vec3 cells_per_metre, uint per_axis, uint first_cell) {
  const uvec3 cell = min(uvec3(max((p - low) * cells_per_metre, vec3(0.0))), uvec3(per_axis - 1u));
  const PlaneCell here = cells[first_cell + (cell.z * per_axis + cell.y) * per_axis + cell.x];
  float depth = here.deepest <= 0.0 || here.shallowest >= push.delta ? 0.0 : 3.0e38;
  for (uint i = 0u; i < here.count && depth > 0.0; ++i) {
    const vec4 plane = planes[here.first + i];
    const float d = plane_depth(Float3(plane.x, plane.y, plane.z), plane.w, Float3(p.x, p.y, p.z));
    depth = d < depth ? d : depth;
  }
  return depth > 0.0 && depth < push.delta ? depth : 0.0;
}

// The first solid that the point is a contact of, with its depth; depth 0: none.
Hit find(vec3 point) {
  if (one_solid) {
    precise vec3 p = point - push.only.centre.xyz;
    if (!inside(p, push.only.low.xyz, push.only.high.xyz)) return Hit(0u, 0.0);
    return Hit(0u, shell_depth(p, push.only.low.xyz, push.only.cells_per_metre.xyz, push.only.cells_per_axis, 0u));
  }
  Hit hit = Hit(0u, 0.0);
  for (uint s = 0u; s < push.solids && hit.depth == 0.0; ++s) {
    precise vec3 p = point - solids[s].centre.xyz;
    const vec3 low = solids[s].low.xyz;
    if (!inside(p, low, solids[s].high.xyz)) continue;
    hit = Hit(s, shell_depth(p, low, solids[s].cells_per_metre.xyz, solids[s].cells_per_axis, solids[s].first_cell));
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
    if (thread == 0u) counts[gl_WorkGroupID.x] = 0u;
    return;
  }
  const uint words = chunk / 32u;
  for (uint w = thread; w < words; w += contacts_group) found[w] = 0u;
  if (thread == 0u) sum = 0u;
  barrier();

  for (uint i = first + thread; i < last; i += contacts_group) {
    const vec3 point = uintBitsToFloat(points[i].xyz);
    if (!is_finite(point.x) || !is_finite(point.y) || !is_finite(point.z)) continue;
    const Hit hit = find(point);
    if (hit.depth == 0.0) continue;
    hits[i] = hit;
    atomicOr(found[(i - first) >> 5u], 1u << (i & 31u));
  }
  barrier();

  uint mine = 0u;
  for (uint w = thread; w < words; w += contacts_group) {
    masks[first / 32u + w] = found[w];
    mine += uint(bitCount(found[w]));
  }
  if (mine != 0u) atomicAdd(sum, mine);
  barrier();
  if (thread == 0u) counts[gl_WorkGroupID.x] = sum;
}
