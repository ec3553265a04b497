// Reads a surface's cells and triangles. Include it after the declarations of the texel buffers and of with_deep.
// surface.h gives the number of texels of each struct.

SurfaceCell surface_cell_at(uint index) {
  const uvec2 words = texelFetch(surface_cells, int(index)).xy;
  return SurfaceCell(words.x, words.y);
}

SurfaceTriangle surface_triangle_at(uint index) {
  const int first = int(index * surface_triangle_texels);
  return SurfaceTriangle(texelFetch(surface_triangles, first), texelFetch(surface_triangles, first + 1),
                         texelFetch(surface_triangles, first + 2), texelFetch(surface_triangles, first + 3));
}

// The cell of a point; the point is relative to the solid's centre.
SurfaceCell surface_cell(vec3 p, vec3 low, float cells_per_metre, uint grid, uint first_cell) {
  precise vec3 rest = (p - low) * cells_per_metre;
  const uint mask = (1u << surface_axis_bits) - 1u;
  const uvec3 size = uvec3(grid & mask, grid >> surface_axis_bits & mask, grid >> 2u * surface_axis_bits);
  const uvec3 at = min(uvec3(max(rest, vec3(0.0))), size - 1u);
  rest -= vec3(at);
  SurfaceCell here = surface_cell_at(first_cell + (at.z * size.y + at.y) * size.x + at.x);
  for (uint level = 0u; level < surface_most_levels && (here.kind & surface_kinds) == surface_divided; ++level) {
    rest *= 2.0;
    const bvec3 upper = greaterThanEqual(rest, vec3(1.0));
    rest -= vec3(upper);
    here = surface_cell_at(here.first + (upper.x ? 1u : 0u) + (upper.y ? 2u : 0u) + (upper.z ? 4u : 0u));
  }
  return here;
}

// The squared distance from the nearest triangle of the cell's runs, and that triangle.
float surface_nearest(SurfaceCell cell, Float3 p, out uint nearest) {
  float least = 3.4e38;
  nearest = 0u;
  uint run = cell.first;
  const uint end = run + (cell.kind & ~surface_kinds);
  uint triangle = 0u;
  uint left = 0u;
  while (run < end || left > 0u) {  // each iteration takes a triangle of a run
    if (left == 0u) {
      const uint word = texelFetch(surface_runs, int(run++)).x;
      triangle = word & (surface_most_triangles - 1u);
      left = (word >> surface_run_bits) + 1u;
    }
    const float distance2 = surface_distance2(surface_triangle_at(triangle), p);
    if (distance2 < least) {
      least = distance2;
      nearest = triangle;
    }
    ++triangle;
    --left;
  }
  return least;
}

bool surface_inside(uint triangle, Float3 p) {
  const SurfaceTriangle t = surface_triangle_at(triangle);
  const OnAxes on = on_axes(t, p);
  const SurfaceFeature feature = surface_feature(t, on);
  const uint corner = feature_corner(feature);
  const int first = int(triangle * surface_signs_texels);
  const uvec4 a = texelFetch(surface_signs, first);
  const uvec2 b = texelFetch(surface_signs, first + 1).xy;
  const SurfaceSigns s = SurfaceSigns(a.x, a.y, a.z, a.w, b.x, b.y, 0u, 0u);
  const uint word = feature.side == 0u ? s.side0 : (feature.side == 1u ? s.side1 : s.side2);
  const uint index = corner == 0u ? s.corner0 : (corner == 1u ? s.corner1 : s.corner2);
  const float beside = side_sign(feature, on, word);
  const float at_corner = corner_sign(t, on, corner, texelFetch(surface_corners, int(index)));
  return (corner == 3u ? beside : at_corner) < 0.0;
}

// Does what contacts_walk requires of look().
float surface_depth(SurfaceCell cell, Float3 p, float delta, out bool shell) {
  shell = false;
  if ((cell.kind & ~surface_kinds) == 0u) return 0.0;
  uint nearest;
  const float distance2 = surface_nearest(cell, p, nearest);
  const bool near = (cell.kind & surface_kinds) == surface_near;
  precise float delta2 = delta * delta;
  shell = near && distance2 < delta2;
  if (!(distance2 > 0.0) || (!shell && !with_deep)) return 0.0;
  if (near && !surface_inside(nearest, p)) return 0.0;
  return sqrt(distance2);
}
