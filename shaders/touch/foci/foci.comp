#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/foci/foci.h"
#include "shaders/touch/foci/foci_math.h"

// Eq. (5)-(7) for one finger per group: sectors and foci. Sums over contacts are integers, so the order does not
// matter.
layout(local_size_x = 128) in;

layout(set = 0, binding = 0) uniform usamplerBuffer grouped;
layout(std430, set = 0, binding = 1) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 2) writeonly buffer Foci { FocusRecord foci[]; };
layout(std430, set = 0, binding = 3) readonly buffer Borders { Border borders[]; };
layout(std430, set = 0, binding = 4) readonly buffer OfSolid { uint foci_of[]; };
layout(push_constant) uniform Push { FociPush push; };

shared Border border[foci_most];
shared int sums[4][foci_most];
shared float radius[outline_bins];
shared Border corner[outline_bins];
shared float way[outline_bins + 1u];  // along the outline: to each corner, and all the way round

Float3 position(uint place) {
  const uvec4 bits = texelFetch(grouped, int(place));
  return Float3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
}

Border equal_angle(uint n, uint count) {
  return borders[count * (count - 1u) / 2u + n];
}

void clear_sums() {
  const uint thread = gl_LocalInvocationIndex;
  if (thread < foci_most) {
    for (uint k = 0u; k < 4u; ++k) sums[k][thread] = 0;
  }
}

// Halves the ascending borders from `sector` on and before `beyond`; p has reached the first of them.
void halve(Float2 p, inout uint sector, inout uint beyond) {
  const uint middle = (sector + beyond) / 2u;
  const bool there = reaches(p, Float2(border[middle].x, border[middle].y));
  if (beyond - sector <= 1u) return;
  if (there) {
    sector = middle;
  } else {
    beyond = middle;
  }
}

// The last of `count` ascending borders that p has reached. There is no loop: a software device ends all loops of a
// shader after 65,535 iterations together, and a finger may have four million contacts.
uint sector_of(Float2 p, uint count) {
  uint sector = 0u;
  uint beyond = p.x == 0.0 && p.y == 0.0 ? 1u : count;
  halve(p, sector, beyond);
  halve(p, sector, beyond);
  halve(p, sector, beyond);
  halve(p, sector, beyond);
  halve(p, sector, beyond);
  halve(p, sector, beyond);
  return sector;
}

Float2 corner_at(uint m) {
  const Border at = corner[m % outline_bins];
  return Float2(at.x, at.y);
}

// Borders that cut the outline into `count` pieces of equal length. `sums` holds the bins' radii and contacts.
void cut_outline(uint count, Scaling scaling, float steps) {
  const uint m = gl_LocalInvocationIndex;
  if (m < outline_bins) {
    uint back = 0u, on = 0u;
    while (back < outline_bins && sums[1][(m + outline_bins - back) % outline_bins] == 0) ++back;
    while (on < outline_bins && sums[1][(m + on) % outline_bins] == 0) ++on;
    const uint before = (m + outline_bins - back) % outline_bins;
    const uint after = (m + on) % outline_bins;
    const float mean_before = mean_radius(sums[0][before], uint(sums[1][before]), steps);
    const float mean_after = mean_radius(sums[0][after], uint(sums[1][after]), steps);
    radius[m] = back == 0u ? mean_before : radius_between(mean_before, mean_after, back, on);
  }
  barrier();
  if (m < outline_bins) {
    const Border direction = equal_angle(m, outline_bins);
    const Float2 at = corner_of(radius[(m + outline_bins - 2u) % outline_bins], radius[(m + outline_bins - 1u) % outline_bins], radius[m],
                                radius[(m + 1u) % outline_bins], Float2(direction.x, direction.y));
    corner[m] = Border(at.x, at.y);
  }
  barrier();
  if (m < outline_bins) way[m + 1u] = metres_between(corner_at(m), corner_at(m + 1u), scaling);
  barrier();
  if (m == 0u) {
    float sum = 0.0;
    way[0] = 0.0;
    for (uint k = 1u; k <= outline_bins; ++k) {
      sum = plus(sum, way[k]);
      way[k] = sum;
    }
  }
  barrier();
  if (m < count) {
    const float share = cut_at(way[outline_bins], m, count);
    uint side = 0u;
    while (side + 1u < outline_bins && way[side + 1u] <= share) ++side;
    const Float2 at = along_side(corner_at(side), corner_at(side + 1u), less(share, way[side]), less(way[side + 1u], way[side]));
    border[m] = Border(at.x, at.y);
  }
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint begin = fingers[finger].start;
  const uint members = fingers[finger].contacts;
  const uint end = begin + members;
  const Float3 origin = position(begin);
  const Float3 mean = Float3(fingers[finger].mean.x, fingers[finger].mean.y, fingers[finger].mean.z);
  const uint own = foci_of[fingers[finger].solid];
  const uint count = min(own == 0u ? push.foci : own, foci_most);

  if (fingers[finger].point_like != 0u) {  // the whole group
    if (thread == 0u) {
      fingers[finger].foci = 1u;
      foci[finger * foci_most] = FocusRecord(origin.x + mean.x, origin.y + mean.y, origin.z + mean.z, members);
    }
    return;
  }
  const vec4 w1 = fingers[finger].axis1, w2 = fingers[finger].axis2, w3 = fingers[finger].axis3;
  const Axes axes = Axes(Float3(w1.x, w1.y, w1.z), Float3(w2.x, w2.y, w2.z), Float3(w3.x, w3.y, w3.z), w1.w, w2.w, w3.w);
  const Scaling scaling = scaling_of(axes.l1, axes.l2, fingers[finger].turn.x, fingers[finger].turn.y);
  const float steps = steps_per_metre(members, axes.l1, axes.l2, axes.l3);

  clear_sums();
  if (push.spacing == spacing_arc) {
    if (thread < outline_bins) border[thread] = equal_angle(thread, outline_bins);
    barrier();
    const float fine = radius_steps(members);
    for (uint k = begin + thread; k < end; k += foci_group) {
      const Float2 p = on_plane(axes, minus(minus(position(k), origin), mean), scaling);
      const uint bin = sector_of(p, outline_bins);
      atomicAdd(sums[0][bin], in_steps(radius_of(p), fine));
      atomicAdd(sums[1][bin], 1);
    }
    barrier();
    cut_outline(count, scaling, fine);
    barrier();
    clear_sums();
  } else if (thread < count) {
    border[thread] = equal_angle(thread, count);
  }
  barrier();

  for (uint k = begin + thread; k < end; k += foci_group) {
    const Float3 d = minus(minus(position(k), origin), mean);
    const uint sector = sector_of(on_plane(axes, d, scaling), count);
    atomicAdd(sums[0][sector], in_steps(d.x, steps));
    atomicAdd(sums[1][sector], in_steps(d.y, steps));
    atomicAdd(sums[2][sector], in_steps(d.z, steps));
    atomicAdd(sums[3][sector], 1);
  }
  barrier();

  if (thread == 0u) fingers[finger].foci = count;
  if (thread < count) {
    const uint points = uint(sums[3][thread]);
    FocusRecord focus = FocusRecord(0.0, 0.0, 0.0, points);
    if (points != 0u) {
      focus.x = focus_coordinate(origin.x, mean.x, sums[0][thread], points, steps);
      focus.y = focus_coordinate(origin.y, mean.y, sums[1][thread], points, steps);
      focus.z = focus_coordinate(origin.z, mean.z, sums[2][thread], points, steps);
    }
    foci[finger * foci_most + thread] = focus;
  }
}
