// Eq. (1)'s depth below the nearest plane of a convex solid. It is 0 outside and, unless `deep`, if the cell lies
// deeper than delta. `p` is relative to the solid's centre, in its axes.
float plane_cell_depth(vec3 p, vec3 low, vec3 cells_per_metre, uint per_axis, uint first_cell, float delta, bool deep) {
  const uvec3 cell = min(uvec3(max((p - low) * cells_per_metre, vec3(0.0))), uvec3(per_axis - 1u));
  const PlaneCell here = cells[first_cell + (cell.z * per_axis + cell.y) * per_axis + cell.x];
  float depth = here.deepest <= 0.0 || (here.shallowest >= delta && !deep) ? 0.0 : 3.0e38;
  for (uint i = 0u; i < here.count && depth > 0.0; ++i) {
    const vec4 plane = planes[here.first + i];
    const float d = plane_depth(Float3(plane.x, plane.y, plane.z), plane.w, Float3(p.x, p.y, p.z));
    depth = d < depth ? d : depth;
  }
  return depth > 0.0 ? depth : 0.0;
}

bool in_box(vec3 p, vec3 low, vec3 high) {
  return all(greaterThanEqual(p, low)) && all(lessThanEqual(p, high));
}

// A world point in a solid's own coordinates.
vec3 in_solid(vec3 point, vec3 centre, vec4 turn) {
  precise vec3 r = point - centre;
  const Float3 p = turned(Float3(turn.x, turn.y, turn.z), turn.w, Float3(r.x, r.y, r.z));
  return vec3(p.x, p.y, p.z);
}
