#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "scan.h"
#include "touch_math.h"

// Eq. (1) for every skin point: inside all planes of a solid, and less than delta below the nearest. Each group leaves its
// contacts compacted in its own stretch of `hits`, and how many they are.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = contacts_points) readonly buffer Points { uvec4 points[]; };
layout(std430, set = 0, binding = contacts_length) readonly buffer Length { ScanTotal given; };
layout(std430, set = 0, binding = contacts_hits) writeonly buffer Hits { Hit hits[]; };
layout(std430, set = 0, binding = contacts_counts) writeonly buffer Counts { uint counts[]; };
layout(std430, set = 0, binding = contacts_solids) readonly buffer Solids { SolidRecord solids[]; };
layout(std430, set = 0, binding = contacts_cells) readonly buffer Cells { PlaneCell cells[]; };
layout(std430, set = 0, binding = contacts_planes) readonly buffer Planes { vec4 planes[]; };
layout(push_constant) uniform Push { ContactsPush push; };

shared uint found[2];

bool inside(vec3 p, vec3 low, vec3 high) {
  return all(greaterThanEqual(p, low)) && all(lessThanEqual(p, high));
}

// Eq. (1)'s depth below the nearest plane if it is in (0, delta), else 0.
float shell_depth(uint solid, vec3 point) {
  precise vec3 p = point - solids[solid].centre.xyz;
  const vec3 low = solids[solid].low.xyz;
  if (!inside(p, low, solids[solid].high.xyz)) return 0.0;
  const uint per_axis = solids[solid].cells_per_axis;
  const uvec3 cell = min(uvec3(max((p - low) * solids[solid].cells_per_metre.xyz, vec3(0.0))), uvec3(per_axis - 1u));
  const PlaneCell here = cells[solids[solid].first_cell + (cell.z * per_axis + cell.y) * per_axis + cell.x];
  if (here.deepest <= 0.0 || here.shallowest >= push.delta) return 0.0;
  float depth = 3.0e38;
  for (uint i = 0u; i < here.count && depth > 0.0; ++i) {
    const vec4 plane = planes[here.first + i];
    const float d = plane_depth(Float3(plane.x, plane.y, plane.z), plane.w, Float3(p.x, p.y, p.z));
    depth = d < depth ? d : depth;
  }
  return depth > 0.0 && depth < push.delta ? depth : 0.0;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint i = gl_GlobalInvocationID.x;
  const uint most = min(given.total, push.most_points);
  if (gl_WorkGroupID.x * contacts_group >= most) return;  // the whole group
  if (thread < 2u) found[thread] = 0u;
  barrier();

  float depth = 0.0;
  uint solid = 0u;
  if (i < most) {
    const uvec4 bits = points[i];
    const vec3 point = uintBitsToFloat(bits.xyz);
    if (is_finite(point.x) && is_finite(point.y) && is_finite(point.z) && inside(point, push.low.xyz, push.high.xyz)) {
      for (uint s = 0u; s < push.solids && depth == 0.0; ++s) {
        depth = shell_depth(s, point);
        solid = s;
      }
    }
  }
  const uint word = thread >> 5u;
  const uint bit = thread & 31u;
  if (depth > 0.0) atomicOr(found[word], 1u << bit);
  barrier();

  const uint low = found[0];
  const uint high = found[1];
  if (thread == 0u) counts[gl_WorkGroupID.x] = uint(bitCount(low) + bitCount(high));
  if (depth > 0.0) {
    const uint mine = word == 0u ? low : high;
    const uint before = uint(bitCount(mine & ((1u << bit) - 1u))) + (word == 0u ? 0u : uint(bitCount(low)));
    Hit hit;
    hit.place = solid << 6u | thread;
    hit.depth = depth;
    hits[gl_WorkGroupID.x * contacts_group + before] = hit;
  }
}
