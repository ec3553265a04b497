// The depth of a point below the surface of a union of convex parts. The shader and its twin include it, see
// engine/touch/contacts/parts_table.hpp. Both give the same bits.
//
// The table is one array of 16-byte words. At a solid's `base`, there is a header word, then two words per cell (x
// fastest). The data that the cells point to can be anywhere behind them:
//   header    x: bits of the tolerance (metres), y: 1 for Eq. (1) of each part alone, cuts included; else 0
//   cell      x, y: first word and number of its part entries, z, w: of its triangles (first word, number)
//             second word: x: bits of the least depth that a point of the cell can have
//   entry     x, y: first word and number of the part's planes that can be the nearest in the cell (0: all of the cell
//             is inside)
//   plane     bits of normal x, y, z and offset
//   triangle  four words: bits of corners a, b, c, each with 1 over the square of the side that begins there (0 for a
//             side without length), then its plane
#ifndef PALPA_SHADERS_PARTS_DEPTH_H
#define PALPA_SHADERS_PARTS_DEPTH_H
#include "shaders/touch/contacts/contacts_math.h"

#ifdef __cplusplus
#define PALPA_PARTS_TABLE const uvec4 *table,
#define PALPA_PARTS_WORD(i) table[i]
#define PALPA_PARTS_PASS table,
PALPA_SHADER_BEGIN
inline float uintBitsToFloat(uint bits) {
  return std::bit_cast<float>(bits);
}
#else
// The includer defines PALPA_PARTS_WORD(i), a uvec4.
#define PALPA_PARTS_TABLE
#define PALPA_PARTS_PASS
PALPA_SHADER_BEGIN
#endif

PALPA_CONST parts_header_words = 1u;
PALPA_CONST parts_cell_words = 2u;
PALPA_CONST parts_triangle_words = 4u;

// The square of the distance to the side from a to b; `scale` is 1 over its length's square.
PALPA_FN float square_to_side(Float3 a, Float3 b, float scale, Float3 p) {
  const Float3 side = minus(b, a);
  const Float3 from = minus(p, a);
  float t = product(dot3(from, side), scale);
  t = t < 0.0f ? 0.0f : t;
  t = t > 1.0f ? 1.0f : t;
  const Float3 off = minus(from, scaled(side, t));
  return dot3(off, off);
}

// Whether p lies on the inner side of the side from a to b, seen along the normal.
PALPA_FN bool within_side(Float3 a, Float3 b, Float3 normal, Float3 p) {
  return dot3(cross3(normal, minus(b, a)), minus(p, a)) >= 0.0f;
}

// The square of the distance from p to the triangle at a word of the table.
PALPA_FN float square_to_triangle(PALPA_PARTS_TABLE uint at, Float3 p) {
  const uvec4 wa = PALPA_PARTS_WORD(at);
  const uvec4 wb = PALPA_PARTS_WORD(at + 1u);
  const uvec4 wc = PALPA_PARTS_WORD(at + 2u);
  const uvec4 wn = PALPA_PARTS_WORD(at + 3u);
  Float3 a, b, c, n;
  a.x = uintBitsToFloat(wa.x);
  a.y = uintBitsToFloat(wa.y);
  a.z = uintBitsToFloat(wa.z);
  b.x = uintBitsToFloat(wb.x);
  b.y = uintBitsToFloat(wb.y);
  b.z = uintBitsToFloat(wb.z);
  c.x = uintBitsToFloat(wc.x);
  c.y = uintBitsToFloat(wc.y);
  c.z = uintBitsToFloat(wc.z);
  n.x = uintBitsToFloat(wn.x);
  n.y = uintBitsToFloat(wn.y);
  n.z = uintBitsToFloat(wn.z);
  if (within_side(a, b, n, p) && within_side(b, c, n, p) && within_side(c, a, n, p)) {
    const float d = plane_depth(n, uintBitsToFloat(wn.w), p);
    return product(d, d);
  }
  float least = square_to_side(a, b, uintBitsToFloat(wa.w), p);
  const float second = square_to_side(b, c, uintBitsToFloat(wb.w), p);
  const float third = square_to_side(c, a, uintBitsToFloat(wc.w), p);
  least = second < least ? second : least;
  return third < least ? third : least;
}

// Depth of p (relative to the solid's centre, inside its box) below the surface; 0 if it is in no part. If the cell
// shows that the depth is at least `limit`, the result is also 0: the caller does not need it. `cell` counts from the
// solid's first cell.
PALPA_FN float parts_depth(PALPA_PARTS_TABLE uint base, uint cell, Float3 p, float limit) {
  const uvec4 header = PALPA_PARTS_WORD(base);
  const uint at = base + parts_header_words + cell * parts_cell_words;
  const uvec4 lists = PALPA_PARTS_WORD(at);
  if (lists.y == 0u || uintBitsToFloat(PALPA_PARTS_WORD(at + 1u).x) >= limit) return 0.0f;
  const float tolerance = uintBitsToFloat(header.x);
  const bool each_alone = header.y != 0u;
  float least = 3.0e38f;
  bool inside = false;
  uint beside = 0u;  // parts that the point lies just outside of
  for (uint e = 0u; e < lists.y && (each_alone || !inside); ++e) {
    const uvec4 entry = PALPA_PARTS_WORD(lists.x + e);
    float depth = 3.0e38f;
    for (uint i = 0u; i < entry.y && depth > -tolerance; ++i) {
      const uvec4 plane = PALPA_PARTS_WORD(entry.x + i);
      Float3 n;
      n.x = uintBitsToFloat(plane.x);
      n.y = uintBitsToFloat(plane.y);
      n.z = uintBitsToFloat(plane.z);
      const float d = plane_depth(n, uintBitsToFloat(plane.w), p);
      depth = d < depth ? d : depth;
    }
    if (depth > 0.0f) {
      inside = true;
      least = depth < least ? depth : least;
    } else if (depth > -tolerance) {
      ++beside;
    }
  }
  if (each_alone) return inside ? least : 0.0f;
  // On the cut between two parts, a point is inside their union, but in neither of them.
  if (!inside && beside < 2u) return 0.0f;
  least = 3.0e38f;
  for (uint i = 0u; i < lists.w; ++i) {
    const float square = square_to_triangle(PALPA_PARTS_PASS lists.z + i * parts_triangle_words, p);
    least = square < least ? square : least;
  }
  return sqrt(least);
}

PALPA_SHADER_END
#endif
