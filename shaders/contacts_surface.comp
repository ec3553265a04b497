#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "contacts_chunk.glsl"
#include "scan.h"
#include "surface_math.h"
#include "touch_math.h"

// As contacts_find, for scenes in which a solid is asked by its surface. Finding a point's cell is cheap and decides most points;
// those whose cell lists triangles are gathered, a tile at a time, so that the threads of a group share the dear part evenly.
layout(local_size_x = 64) in;
layout(constant_id = 0) const bool with_deep = false;
layout(constant_id = 1) const bool with_parts = false;

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
layout(std430, set = 0, binding = contacts_surface_cells) readonly buffer SurfaceCells { SurfaceCell surface_cells[]; };
layout(std430, set = 0, binding = contacts_surface_runs) readonly buffer Runs { uint runs[]; };
layout(std430, set = 0, binding = contacts_surface_triangles) readonly buffer Triangles { SurfaceTriangle triangles[]; };
layout(std430, set = 0, binding = contacts_surface_signs) readonly buffer Signs { SurfaceSigns signs[]; };
layout(std430, set = 0, binding = contacts_surface_corners) readonly buffer Corners { vec4 corners[]; };
layout(std430, set = 0, binding = contacts_parts) readonly buffer Parts { uvec4 parts_words[]; };
layout(push_constant) uniform Push { ContactsPush push; };

#define PALPA_PARTS_WORD(i) parts_words[i]
#include "parts_depth.h"

#include "contacts_planes.glsl"
#include "surface_query.glsl"

// What is known of a tile's points: no_hit, or a solid, plus deep_hit while it may still turn out to be another's contact.
const uint no_hit = 0xffffffffu;
const uint no_point = 0xfffffffeu;
const uint deep_hit = 0x80000000u;
shared uint hit_solid[contacts_tile];
shared float hit_depth[contacts_tile];
shared uint waiting[contacts_tile];  // points whose cells list triangles
shared SurfaceCell waiting_cell[contacts_tile];
shared uint waiting_count;
shared uint words[contacts_tile / 32u];
shared uint deep_words[contacts_tile / 32u];
shared uint sum, deep_sum;

void note(uint k, uint solid, float depth, bool deep) {
  if (deep && (!with_deep || depth == 0.0 || hit_solid[k] != no_hit)) return;  // the first solid of several counts
  hit_solid[k] = deep ? solid | deep_hit : solid;
  hit_depth[k] = depth;
}

bool undecided(uint k) {
  return hit_solid[k] == no_hit || (with_deep && (hit_solid[k] & deep_hit) != 0u && hit_solid[k] != no_point);
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
  if (thread == 0u) {
    sum = 0u;
    deep_sum = 0u;
    waiting_count = 0u;
  }
  for (uint tile = first; tile < last; tile += contacts_tile) {
    const uint size = min(contacts_tile, last - tile);
    for (uint k = thread; k < size; k += contacts_group) {
      const vec3 point = uintBitsToFloat(points[tile + k].xyz);
      hit_solid[k] = is_finite(point.x) && is_finite(point.y) && is_finite(point.z) ? no_hit : no_point;
    }
    if (thread < contacts_tile / 32u) {
      words[thread] = 0u;
      deep_words[thread] = 0u;
    }
    barrier();

    for (uint s = 0u; s < push.solids; ++s) {
      const SolidRecord solid = solids[s];
      const float delta = solid.delta > 0.0 ? solid.delta : push.delta;
      for (uint k = thread; k < size; k += contacts_group) {
        if (!undecided(k)) continue;
        const vec3 p = in_solid(uintBitsToFloat(points[tile + k].xyz), solid.centre, solid.low.w, solid.high.w,
                                solid.cells_per_metre.w);
        if (!in_box(p, solid.low.xyz, solid.high.xyz)) continue;
        if (with_parts && solid.by_surface == asked_by_parts) {
          const uint cell = parts_cell(Float3(p.x, p.y, p.z), Float3(solid.low.x, solid.low.y, solid.low.z),
                                       Float3(solid.cells_per_metre.x, solid.cells_per_metre.y, solid.cells_per_metre.z),
                                       solid.cells_per_axis);
          const float depth = parts_depth(solid.first_cell, cell, Float3(p.x, p.y, p.z), with_deep ? 3.0e38 : delta);
          if (depth > 0.0) note(k, s, depth, depth >= delta);
          continue;
        }
        if (solid.by_surface == 0u) {
          const float depth = plane_cell_depth(p, solid.low.xyz, solid.cells_per_metre.xyz, solid.cells_per_axis,
                                               solid.first_cell, delta, with_deep);
          if (depth > 0.0) note(k, s, depth, depth >= delta);
          continue;
        }
        const SurfaceCell cell =
            surface_cell(p, solid.low.xyz, solid.cells_per_metre.x, solid.cells_per_axis, solid.first_cell);
        if ((cell.kind & ~surface_kinds) == 0u) continue;
        const uint place = atomicAdd(waiting_count, 1u);  // in any order: each point is looked at by itself
        waiting[place] = k;
        waiting_cell[place] = cell;
      }
      barrier();
      const uint others = waiting_count;
      barrier();
      if (thread == 0u) waiting_count = 0u;
      for (uint j = thread; j < others; j += contacts_group) {
        const uint k = waiting[j];
        const SurfaceCell cell = waiting_cell[j];
        const vec3 at = in_solid(uintBitsToFloat(points[tile + k].xyz), solid.centre, solid.low.w, solid.high.w,
                                 solid.cells_per_metre.w);
        const Float3 p = Float3(at.x, at.y, at.z);
        uint nearest;
        const float distance2 = surface_nearest(cell, p, nearest);
        const bool near = (cell.kind & surface_kinds) == surface_near;
        precise float delta2 = delta * delta;
        const bool in_shell = near && distance2 < delta2;
        if (!(distance2 > 0.0) || (!in_shell && !with_deep)) continue;
        if (near && !surface_inside(nearest, p)) continue;
        note(k, s, sqrt(distance2), !in_shell);
      }
      barrier();
    }

    for (uint k = thread; k < size; k += contacts_group) {
      const uint solid = hit_solid[k];
      if (solid == no_hit || solid == no_point) continue;
      hits[tile + k] = Hit(solid & ~deep_hit, hit_depth[k]);
      if ((solid & deep_hit) == 0u) {
        atomicOr(words[k >> 5u], 1u << (k & 31u));
      } else if (with_deep) {
        atomicOr(deep_words[k >> 5u], 1u << (k & 31u));
      }
    }
    barrier();
    // The chunk's masks are whole words, beyond its last point too.
    if (thread < min(contacts_tile, first + chunk - tile) / 32u) {
      masks[tile / 32u + thread] = words[thread];
      atomicAdd(sum, uint(bitCount(words[thread])));
      if (with_deep) {
        deep_masks[tile / 32u + thread] = deep_words[thread];
        atomicAdd(deep_sum, uint(bitCount(deep_words[thread])));
      }
    }
    barrier();
  }
  // `last` may end a tile before the chunk does.
  const uint done = first + (last - first + contacts_tile - 1u) / contacts_tile * contacts_tile;
  for (uint w = done / 32u + thread; w < (first + chunk) / 32u; w += contacts_group) {
    masks[w] = 0u;
    if (with_deep) deep_masks[w] = 0u;
  }
  if (thread == 0u) {
    counts[gl_WorkGroupID.x] = sum;
    if (with_deep) deep_counts[gl_WorkGroupID.x] = deep_sum;
  }
}
