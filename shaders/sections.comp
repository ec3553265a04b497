#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "scan.h"
#include "sections.h"
#include "touch_math.h"

// Eq. (2)-(7) for one finger per group: centroid, covariance, axes, sectors, foci. Sums run in a fixed order: each thread
// adds its own contacts in theirs, then the threads' sums are added in thread order; the sectors' sums are integers, where
// order does not matter.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = sections_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = sections_parents) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = sections_contacts) buffer Contacts { uvec4 contacts[]; };  // ContactRecord, in halves
layout(std430, set = 0, binding = sections_fingers) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = sections_foci) writeonly buffer Foci { FocusRecord foci[]; };
layout(std430, set = 0, binding = sections_borders) readonly buffer Borders { Border borders[]; };
layout(push_constant) uniform Push { SectionsPush push; };

shared float partial[6][sections_group];
shared float totals[6];
shared Axes axes;
shared float scales[3];
shared Border border[sections_most_foci];
shared int sums[4][sections_most_foci];

Float3 position(uint i) {
  const uvec4 bits = contacts[2u * i];
  return Float3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
}

// totals[k] = sum of partial[k], for the first `rows` rows.
void reduce(uint rows) {
  barrier();
  const uint row = gl_LocalInvocationIndex;
  if (row < rows) {
    Sum sum = Sum(0.0, 0.0);
    for (uint t = 0u; t < sections_group; ++t) sum = add(sum, partial[row][t]);
    totals[row] = sum.sum;
  }
  barrier();
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint count = min(found.total, push.most_contacts);
  const uint first = fingers[finger].first;
  const uint root = parents[first];
  const uint members = fingers[finger].contacts;
  const float share = 1.0 / float(members);
  const Float3 origin = position(first);

  if (thread < push.foci) {
    border[thread] = borders[push.foci * (push.foci - 1u) / 2u + thread];
    for (uint k = 0u; k < 4u; ++k) sums[k][thread] = 0;
  }

  // The first look at all contacts chains this thread's own, so that the later ones see no others.
  Sum x = Sum(0.0, 0.0), y = x, z = x;
  uint head = no_finger;
  uint tail = no_finger;
  for (uint i = thread; i < count; i += sections_group) {
    if (parents[i] != root) continue;
    const Float3 d = minus(position(i), origin);
    x = add(x, d.x);
    y = add(y, d.y);
    z = add(z, d.z);
    contacts[2u * i + 1u].z = finger;
    if (tail == no_finger) {
      head = i;
    } else {
      contacts[2u * tail + 1u].w = i;
    }
    tail = i;
  }
  partial[0][thread] = x.sum;
  partial[1][thread] = y.sum;
  partial[2][thread] = z.sum;
  reduce(3u);
  const Float3 mean = scaled(Float3(totals[0], totals[1], totals[2]), share);  // relative to the origin
  barrier();

  Sum xx = Sum(0.0, 0.0), xy = xx, xz = xx, yy = xx, yz = xx, zz = xx;
  for (uint i = head, k = 0u; i != no_finger && k < count; i = contacts[2u * i + 1u].w, ++k) {
    const Float3 d = minus(minus(position(i), origin), mean);
    xx = add(xx, product(d.x, d.x));
    xy = add(xy, product(d.x, d.y));
    xz = add(xz, product(d.x, d.z));
    yy = add(yy, product(d.y, d.y));
    yz = add(yz, product(d.y, d.z));
    zz = add(zz, product(d.z, d.z));
  }
  partial[0][thread] = xx.sum;
  partial[1][thread] = xy.sum;
  partial[2][thread] = xz.sum;
  partial[3][thread] = yy.sum;
  partial[4][thread] = yz.sum;
  partial[5][thread] = zz.sum;
  reduce(6u);

  if (thread == 0u) {
    const Sym3 covariance = Sym3(product(totals[0], share), product(totals[1], share), product(totals[2], share), product(totals[3], share),
                                 product(totals[4], share), product(totals[5], share));
    axes = principal_axes(covariance);
    const bool point_like = is_point_like(members, axes.l1, axes.l2);
    scales[0] = point_like ? 0.0 : 1.0 / sqrt(axes.l1);
    scales[1] = point_like ? 0.0 : 1.0 / sqrt(axes.l2);
    scales[2] = point_like ? 0.0 : steps_per_metre(members, axes);
    fingers[finger].point_like = point_like ? 1u : 0u;
    fingers[finger].centre = vec4(origin.x + mean.x, origin.y + mean.y, origin.z + mean.z, 0.0);
    fingers[finger].axis1 = vec4(axes.w1.x, axes.w1.y, axes.w1.z, axes.l1);
    fingers[finger].axis2 = vec4(axes.w2.x, axes.w2.y, axes.w2.z, axes.l2);
    fingers[finger].axis3 = vec4(axes.w3.x, axes.w3.y, axes.w3.z, axes.l3);
  }
  barrier();

  const float steps = scales[2];
  if (steps == 0.0) {  // the whole group: point-like
    if (thread == 0u) {
      foci[finger * sections_most_foci] = FocusRecord(origin.x + mean.x, origin.y + mean.y, origin.z + mean.z, members);
    }
    return;
  }
  const Axes frame = axes;
  for (uint i = head, k = 0u; i != no_finger && k < count; i = contacts[2u * i + 1u].w, ++k) {
    const Float3 d = minus(minus(position(i), origin), mean);
    const Float2 p = on_plane(frame, d, scales[0], scales[1]);
    uint sector = 0u;
    if (p.x != 0.0 || p.y != 0.0) {
      for (uint n = 1u; n < push.foci; ++n) sector += reaches(p, Float2(border[n].x, border[n].y)) ? 1u : 0u;
    }
    atomicAdd(sums[0][sector], in_steps(d.x, steps));
    atomicAdd(sums[1][sector], in_steps(d.y, steps));
    atomicAdd(sums[2][sector], in_steps(d.z, steps));
    atomicAdd(sums[3][sector], 1);
  }
  barrier();

  if (thread < push.foci) {
    const uint points = uint(sums[3][thread]);
    FocusRecord focus = FocusRecord(0.0, 0.0, 0.0, points);
    if (points != 0u) {
      focus.x = focus_coordinate(origin.x, mean.x, sums[0][thread], points, steps);
      focus.y = focus_coordinate(origin.y, mean.y, sums[1][thread], points, steps);
      focus.z = focus_coordinate(origin.z, mean.z, sums[2][thread], points, steps);
    }
    foci[finger * sections_most_foci + thread] = focus;
  }
}
