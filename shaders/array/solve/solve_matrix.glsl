// R = G B of a slot, tile by tile: one workgroup walks over all transducers for `tile` rows and as many columns. If
// rows and columns are different foci, it also computes their mirror image. The transfer between a transducer and a
// focus is recomputed in each tile: reading it back would take longer on every device tried.
//
// With SOLVE_MIRRORED defined: the tiles off the diagonal; without, those on it.
#include "shaders/array/solve/solve_inputs.glsl"

layout(constant_id = 2) const uint tile = 5u;

layout(std430, set = 0, binding = 5) writeonly buffer Matrices { vec2 matrices[]; };

#ifdef SOLVE_MIRRORED
const uint kinds = 2u;
#else
const uint kinds = 1u;
#endif
const uint entries = kinds * tile * tile;

shared vec2 partial[solve_group * entries];

void fill_tile(DriveSlot slot, uint row_tile, uint column_tile) {
  Place rows[tile];
  [[unroll]] for (uint i = 0u; i < tile; ++i)
    rows[i] = place_of(slot.first + min(row_tile * tile + i, slot.count - 1u));
#ifdef SOLVE_MIRRORED
  Place columns[tile];
  [[unroll]] for (uint i = 0u; i < tile; ++i)
    columns[i] = place_of(slot.first + min(column_tile * tile + i, slot.count - 1u));
#endif

  vec2 sum[entries];
  [[unroll]] for (uint e = 0u; e < entries; ++e) sum[e] = vec2(0.0);

  const uint thread = gl_LocalInvocationIndex;
  for (uint n = thread; n < push.transducers; n += solve_group) {
    const Source source = source_of(n);
    Pair of_rows[tile];
    [[unroll]] for (uint i = 0u; i < tile; ++i) of_rows[i] = pair_of(source, rows[i]);
#ifdef SOLVE_MIRRORED
    Pair of_columns[tile];
    [[unroll]] for (uint i = 0u; i < tile; ++i) of_columns[i] = pair_of(source, columns[i]);
#endif
    [[unroll]] for (uint c = 0u; c < tile; ++c) {
      [[unroll]] for (uint r = 0u; r < tile; ++r) {
#ifdef SOLVE_MIRRORED
        const Pair other = of_columns[c];
#else
        const Pair other = of_rows[c];
#endif
        // e^{ik(d_row - d_column)}
        const vec2 turned = vec2(of_rows[r].unit.x * other.unit.x + of_rows[r].unit.y * other.unit.y,
                                 of_rows[r].unit.y * other.unit.x - of_rows[r].unit.x * other.unit.y);
        sum[c * tile + r] += turned * (of_rows[r].loud * other.asked);
#ifdef SOLVE_MIRRORED
        sum[tile * tile + c * tile + r] += vec2(turned.x, -turned.y) * (other.loud * of_rows[r].asked);
#endif
      }
    }
  }
  [[unroll]] for (uint e = 0u; e < entries; ++e) partial[e * solve_group + thread] = sum[e];
  barrier();
  for (uint e = thread; e < entries; e += solve_group) {
    vec2 total = vec2(0.0);
    for (uint t = 0u; t < solve_group; ++t) total += partial[e * solve_group + t];
    const uint r = row_tile * tile + e % tile;
    const uint c = column_tile * tile + (e / tile) % tile;
    if (r >= slot.count || c >= slot.count) continue;
    const bool mirrored = e >= tile * tile;
    matrices[slot.solved + (mirrored ? r * slot.count + c : c * slot.count + r)] = total;
  }
}
