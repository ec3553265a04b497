// The true surface of a solid: its triangles, each in its own axes, and cells that list the triangles that can be the
// nearest. Shared by engine/geometry/surface*.cpp, engine/touch/contacts*.cpp and
// shaders/touch/contacts/contacts_surface.comp.
#ifndef PALPA_SHADERS_SURFACE_H
#define PALPA_SHADERS_SURFACE_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// A triangle. Its first side is its longest. Its axes are that side's direction, the direction across it, and the
// normal. The numbers are computed in double precision, so the distance to a needle is as exact as that to any other
// triangle.
struct SurfaceTriangle {
  vec4 corner;  // start of the first side, relative to the solid's centre; w: length of the first side
  vec4 normal;  // unit, outwards; w: direction of the second side along the first
  vec4 along;   // unit, along the first side; w: direction of the second side across it
  vec4 rest;    // x: length of the second side; y, z: direction of the third side along and across; w: its length
};
PALPA_CHECK_SIZE(SurfaceTriangle, 64);
PALPA_CHECK_OFFSET(SurfaceTriangle, normal, 16);
PALPA_CHECK_OFFSET(SurfaceTriangle, along, 32);
PALPA_CHECK_OFFSET(SurfaceTriangle, rest, 48);
PALPA_CONST surface_triangle_texels = 4u;  // of 16 bytes

// Gives the side of the surface for a point whose nearest place is on one of the triangle's sides or corners
// (Baerentzen and Aanaes 2005). A side's word holds two 16-bit integers: its pseudonormal across the side, outwards,
// and along the triangle's normal.
struct SurfaceSigns {
  uint side0, side1, side2;
  uint corner0, corner1, corner2;  // index into the corners' pseudonormals
  uint unused0, unused1;
};
PALPA_CHECK_SIZE(SurfaceSigns, 32);
PALPA_CHECK_OFFSET(SurfaceSigns, corner0, 12);
PALPA_CONST surface_signs_texels = 2u;  // of 16 bytes

// A cell of a solid's box. The first cells of a solid are a grid, x fastest. A divided cell has eight children, x
// fastest.
struct SurfaceCell {
  uint first;  // divided: its first child's index; else its first run's
  uint kind;   // one of surface_*; plus the number of runs
};
PALPA_CHECK_SIZE(SurfaceCell, 8);
PALPA_CHECK_OFFSET(SurfaceCell, kind, 4);

PALPA_CONST surface_outside = 0u;        // no point of it is inside the solid
PALPA_CONST surface_near = 0x40000000u;  // its runs have every triangle that is nearest to any of its points
PALPA_CONST surface_deep = 0x80000000u;  // inside, farther from the surface than the table's reach; its runs give the
                                         // depth within two percent; no runs if deep points were not asked for
PALPA_CONST surface_divided = 0xc0000000u;
PALPA_CONST surface_kinds = 0xc0000000u;

// A run of triangles: the first one's index in the low bits, the number of those that follow in the high byte.
PALPA_CONST surface_run_bits = 24u;
PALPA_CONST surface_most_triangles = 0x1000000u;  // all solids of a scene together
PALPA_CONST surface_longest_run = 256u;
PALPA_CONST surface_most_levels = 12u;  // a cell is divided at most this many times

// The grid's cells along x, y and z in one word, ten bits each.
PALPA_CONST surface_axis_bits = 10u;

PALPA_SHADER_END
#endif
