#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/sections/sections.h"
#include "shaders/touch/sections/sections_math.h"

// Eq. (2)-(4) for one finger per group: centroid, covariance, principal axes; and the direction in which its contacts
// lie deeper. Sums have a fixed order: each thread adds its own contacts in their order, then the threads' sums are
// added in thread order.
layout(local_size_x = 128) in;

layout(set = 0, binding = 0) uniform usamplerBuffer grouped;
layout(std430, set = 0, binding = 1) buffer Fingers { FingerRecord fingers[]; };

const uint sums = 9u;
shared float partial[sums][sections_group];
shared float totals[sums];

Float3 position(uvec4 bits) {
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
  const uint begin = fingers[finger].start;
  const uint members = fingers[finger].contacts;
  const uint end = begin + members;
  const float share = 1.0 / float(members);
  const Float3 origin = position(texelFetch(grouped, int(begin)));

  Sum x = Sum(0.0, 0.0), y = x, z = x;
  for (uint k = begin + thread; k < end; k += sections_group) {
    const Float3 d = minus(position(texelFetch(grouped, int(k))), origin);
    x = add(x, d.x);
    y = add(y, d.y);
    z = add(z, d.z);
  }
  partial[0][thread] = x.sum;
  partial[1][thread] = y.sum;
  partial[2][thread] = z.sum;
  reduce(3u);
  const Float3 mean = scaled(Float3(totals[0], totals[1], totals[2]), share);  // relative to the origin
  barrier();

  Sum xx = Sum(0.0, 0.0), xy = xx, xz = xx, yy = xx, yz = xx, zz = xx, lean_x = xx, lean_y = xx, lean_z = xx;
  for (uint k = begin + thread; k < end; k += sections_group) {
    const uvec4 bits = texelFetch(grouped, int(k));
    const Float3 d = minus(minus(position(bits), origin), mean);
    const float depth = uintBitsToFloat(bits.w);
    xx = add(xx, product(d.x, d.x));
    xy = add(xy, product(d.x, d.y));
    xz = add(xz, product(d.x, d.z));
    yy = add(yy, product(d.y, d.y));
    yz = add(yz, product(d.y, d.z));
    zz = add(zz, product(d.z, d.z));
    lean_x = add(lean_x, product(d.x, depth));
    lean_y = add(lean_y, product(d.y, depth));
    lean_z = add(lean_z, product(d.z, depth));
  }
  partial[0][thread] = xx.sum;
  partial[1][thread] = xy.sum;
  partial[2][thread] = xz.sum;
  partial[3][thread] = yy.sum;
  partial[4][thread] = yz.sum;
  partial[5][thread] = zz.sum;
  partial[6][thread] = lean_x.sum;
  partial[7][thread] = lean_y.sum;
  partial[8][thread] = lean_z.sum;
  reduce(sums);

  if (thread == 0u) {
    const Sym3 covariance = Sym3(product(totals[0], share), product(totals[1], share), product(totals[2], share), product(totals[3], share),
                                 product(totals[4], share), product(totals[5], share));
    const Axes axes = principal_axes(covariance);
    fingers[finger].point_like = is_point_like(members, axes.l1, axes.l2) ? 1u : 0u;
    fingers[finger].id = finger;
    fingers[finger].centre = vec4(origin.x + mean.x, origin.y + mean.y, origin.z + mean.z, 0.0);
    fingers[finger].axis1 = vec4(axes.w1.x, axes.w1.y, axes.w1.z, axes.l1);
    fingers[finger].axis2 = vec4(axes.w2.x, axes.w2.y, axes.w2.z, axes.l2);
    fingers[finger].axis3 = vec4(axes.w3.x, axes.w3.y, axes.w3.z, axes.l3);
    fingers[finger].turn = vec4(1.0, 0.0, 0.0, 0.0);
    fingers[finger].placed = 0u;
    fingers[finger].held_low = 0u;
    fingers[finger].held_high = 0u;
    fingers[finger].beyond = 0u;
    fingers[finger].holds = 0u;
    fingers[finger].mean = vec4(mean.x, mean.y, mean.z, 0.0);
    fingers[finger].lean = vec4(product(totals[6], share), product(totals[7], share), product(totals[8], share), 0.0);
  }
}
