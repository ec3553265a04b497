// The arithmetic of contacts, for the shaders and their twin; see exact_math.h.
#ifndef PALPA_SHADERS_CONTACTS_MATH_H
#define PALPA_SHADERS_CONTACTS_MATH_H
#include "shaders/shared/exact_math.h"
#include "shaders/touch/contacts/contacts.h"
#ifdef __cplusplus
#define PALPA_PLANE_TABLES const PlaneCell *cells, const vec4 *planes,
#else
// The includer has the buffers `cells` and `planes`.
#define PALPA_PLANE_TABLES
#endif
PALPA_SHADER_BEGIN

// A world point in a solid's own coordinates.
PALPA_FN Float3 in_solid(Float3 point, vec4 centre, vec4 turn) {
  return turned(xyz_of(turn), turn.w, minus(point, xyz_of(centre)));
}

// Eq. (1)'s (x_m - x) . n_m for the plane dot(n, x) = offset.
PALPA_FN float plane_depth(Float3 normal, float offset, Float3 point) {
  PALPA_EXACT float depth = offset - (normal.x * point.x + normal.y * point.y + normal.z * point.z);
  return depth;
}

PALPA_FN uint cell_along(float p, float low, float cells_per_metre, uint per_axis) {
  const float along = product(p - low, cells_per_metre);
  const uint cell = along > 0.0f ? uint(along) : 0u;
  return cell < per_axis ? cell : per_axis - 1u;
}

// The cell of a point in a solid's box, in its coordinates, counting from the solid's first.
PALPA_FN uint cell_of(Float3 p, vec4 low, vec4 cells_per_metre, uint per_axis) {
  const uint x = cell_along(p.x, low.x, cells_per_metre.x, per_axis);
  const uint y = cell_along(p.y, low.y, cells_per_metre.y, per_axis);
  const uint z = cell_along(p.z, low.z, cells_per_metre.z, per_axis);
  return (z * per_axis + y) * per_axis + x;
}

// Eq. (1)'s depth below the nearest plane of a convex solid, in whose cell number `cell` the point lies. It is 0
// outside and, unless `deep`, if the cell lies deeper than delta.
PALPA_FN float plane_cell_depth(PALPA_PLANE_TABLES uint cell, Float3 p, float delta, bool deep) {
  const PlaneCell here = cells[cell];
  float depth = here.deepest <= 0.0f || (here.shallowest >= delta && !deep) ? 0.0f : 3.0e38f;
  for (uint i = 0u; i < here.count && depth > 0.0f; ++i) {
    const vec4 plane = planes[here.first + i];
    const float d = plane_depth(xyz_of(plane), plane.w, p);
    depth = d < depth ? d : depth;
  }
  return depth > 0.0f ? depth : 0.0f;
}

PALPA_SHADER_END
#endif
