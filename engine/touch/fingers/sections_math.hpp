// The arithmetic of cross-sections, Eq. (2)-(4).
#pragma once

#include <cmath>
#include <cstdint>

#include "touch/fingers/exact.hpp"

namespace palpa::touch {

/// A running sum and the part that rounding has removed (Kahan): the error stays at one rounding, however many terms.
struct Sum {
  float sum, lost;
};

inline Sum add(Sum s, float term) {
  float y = term - s.lost;
  float t = s.sum + y;
  float taken = t - s.sum;
  Sum r;
  float lost = taken - y;
  r.sum = t;
  r.lost = lost;
  return r;
}

/// A symmetric matrix.
struct Sym3 {
  float xx, xy, xz, yy, yz, zz;
};

struct PrincipalAxes {
  Float3 w1, w2, w3;
  float l1, l2, l3;  // eigenvalues, l1 >= l2 >= l3 >= 0
};

inline float largest_component(Float3 a) {
  float largest = a.x;
  if (std::abs(a.y) > std::abs(largest)) largest = a.y;
  if (std::abs(a.z) > std::abs(largest)) largest = a.z;
  return largest;
}

/// An axis with the sign that it has by itself: it points upwards (y >= 0; if it is within 1e-6 of the horizontal, z,
/// then x, is positive).
inline Float3 upwards(Float3 a) {
  float decides = a.y;
  if (std::abs(decides) < 1e-6F) decides = a.z;
  if (std::abs(a.y) < 1e-6F && std::abs(decides) < 1e-6F) decides = a.x;
  return decides < 0.0F ? scaled(a, -1.0F) : a;
}

/// Cyclic Jacobi rotations on a matrix scaled to trace 1; ten sweeps are three more than any 3x3 float matrix needs.
/// Always finite and orthonormal: the zero matrix gives w1 = x, w3 = y, w2 = w3 x w1 = -z.
/// Signs: w3 points upwards, w1's largest component is positive, w2 = w3 x w1.
inline PrincipalAxes principal_axes(Sym3 m) {
  const float trace = m.xx + m.yy + m.zz;
  const bool empty = !(trace > 0.0F);
  const float scale = empty ? 0.0F : 1.0F / trace;
  float a[3][3];
  float v[3][3];
  a[0][0] = m.xx * scale;
  a[1][1] = m.yy * scale;
  a[2][2] = m.zz * scale;
  a[0][1] = m.xy * scale;
  a[0][2] = m.xz * scale;
  a[1][2] = m.yz * scale;
  a[1][0] = a[0][1];
  a[2][0] = a[0][2];
  a[2][1] = a[1][2];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      v[i][j] = i == j ? 1.0F : 0.0F;
  }
  for (int turn = 0; turn < 30; ++turn) {
    if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) <= 1e-12F) break;
    const int pair = turn % 3;
    const int p = pair == 2 ? 1 : 0;
    const int q = pair == 0 ? 1 : 2;
    const int o = 3 - p - q;
    const float apq = a[p][q];
    if (std::abs(apq) <= 1e-12F) continue;  // far below the last digit of a trace of 1
    float theta = (a[q][q] - a[p][p]) / (2.0F * apq);
    float root = std::abs(theta) + std::sqrt(theta * theta + 1.0F);
    float t = (theta < 0.0F ? -1.0F : 1.0F) / root;
    float c = 1.0F / std::sqrt(t * t + 1.0F);
    float s = t * c;
    float app = a[p][p] - t * apq;
    float aqq = a[q][q] + t * apq;
    float aop = c * a[o][p] - s * a[o][q];
    float aoq = s * a[o][p] + c * a[o][q];
    a[p][p] = app;
    a[q][q] = aqq;
    a[p][q] = 0.0F;
    a[q][p] = 0.0F;
    a[o][p] = aop;
    a[p][o] = aop;
    a[o][q] = aoq;
    a[q][o] = aoq;
    for (int row = 0; row < 3; ++row) {
      float vp = c * v[row][p] - s * v[row][q];
      float vq = s * v[row][p] + c * v[row][q];
      v[row][p] = vp;
      v[row][q] = vq;
    }
  }
  int first = 0, middle = 1, last = 2;
  if (empty) {
    middle = 2;
    last = 1;
  }
  if (a[first][first] < a[middle][middle]) {
    const int swapped = first;
    first = middle;
    middle = swapped;
  }
  if (a[middle][middle] < a[last][last]) {
    const int swapped = middle;
    middle = last;
    last = swapped;
  }
  if (a[first][first] < a[middle][middle]) {
    const int swapped = first;
    first = middle;
    middle = swapped;
  }
  PrincipalAxes r;
  r.w1.x = v[0][first];
  r.w1.y = v[1][first];
  r.w1.z = v[2][first];
  r.w3.x = v[0][last];
  r.w3.y = v[1][last];
  r.w3.z = v[2][last];
  r.w1 = unit(r.w1);
  r.w3 = upwards(unit(minus(r.w3, scaled(r.w1, dot3(r.w1, r.w3)))));
  if (largest_component(r.w1) < 0.0F) r.w1 = scaled(r.w1, -1.0F);
  r.w2 = cross3(r.w3, r.w1);
  float l1 = a[first][first] * trace;
  float l2 = a[middle][middle] * trace;
  float l3 = a[last][last] * trace;
  r.l1 = l1 > 0.0F ? l1 : 0.0F;
  r.l2 = l2 > 0.0F ? l2 : 0.0F;
  r.l3 = l3 > 0.0F ? l3 : 0.0F;
  return r;
}

/// A finger without a cross-section: fewer than 3 contacts; coincident ones (a spread below a tenth of a micrometre,
/// the spacing of single-precision coordinates a metre from the origin); collinear ones (a thousand times longer than
/// wide: below that, the covariance's second eigenvalue is rounding).
inline constexpr std::uint32_t point_like_contacts = 3U;
inline bool is_point_like(std::uint32_t contacts, float l1, float l2) {
  return contacts < point_like_contacts || l1 <= 1e-14F || l2 <= 1e-6F * l1;
}

}  // namespace palpa::touch
