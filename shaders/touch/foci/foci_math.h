// The arithmetic of foci, for foci.comp and its twin; see exact_math.h.
#ifndef PALPA_SHADERS_FOCI_MATH_H
#define PALPA_SHADERS_FOCI_MATH_H
#include "shaders/touch/sections/sections_math.h"
PALPA_SHADER_BEGIN

// Eq. (5)'s scaling to equal variance and back, as symmetric matrices, for in-plane axes w1 and w2. In their
// coordinates, the first principal direction is (cosine, sine). For the principal axes themselves, they are Eq. (5)'s 1
// / sqrt(l).
struct Scaling {
  float xx, xy, yy;
  float back_xx, back_xy, back_yy;
};

PALPA_FN Scaling scaling_of(float l1, float l2, float cosine, float sine) {
  PALPA_EXACT float root1 = sqrt(l1);
  PALPA_EXACT float root2 = sqrt(l2);
  PALPA_EXACT float scale1 = 1.0f / root1;
  PALPA_EXACT float scale2 = 1.0f / root2;
  PALPA_EXACT Scaling r;
  r.xx = scale1 * cosine * cosine + scale2 * sine * sine;
  r.xy = (scale1 - scale2) * cosine * sine;
  r.yy = scale1 * sine * sine + scale2 * cosine * cosine;
  r.back_xx = root1 * cosine * cosine + root2 * sine * sine;
  r.back_xy = (root1 - root2) * cosine * sine;
  r.back_yy = root1 * sine * sine + root2 * cosine * cosine;
  return r;
}

// Eq. (5) with its second coordinate negated: angles of (x, y) run clockwise seen from the tip of w3, so y counts
// against w2.
PALPA_FN Float2 on_plane(Axes axes, Float3 from_centroid, Scaling scaling) {
  const float x = dot3(axes.w1, from_centroid);
  const float y = dot3(axes.w2, from_centroid);
  PALPA_EXACT Float2 r;
  r.x = x * scaling.xx + y * scaling.xy;
  r.y = -(x * scaling.xy + y * scaling.yy);
  return r;
}

// Angles in [pi, 2 pi).
PALPA_FN bool in_second_half(Float2 p) {
  return p.y < 0.0f || (p.y == 0.0f && p.x < 0.0f);
}

// Whether p's angle is at least the border's, both in [0, 2 pi). It uses no arctangent, so devices cannot disagree
// about its last digits.
PALPA_FN bool reaches(Float2 p, Float2 border) {
  const bool second = in_second_half(p);
  const bool border_second = in_second_half(border);
  PALPA_EXACT float turn = border.x * p.y - border.y * p.x;
  return second == border_second ? turn >= 0.0f : second;
}

// Sector sums are integers, so their order does not matter. The steps are as fine as 31 bits allow: the sum of all
// distances from the centroid is at most contacts * sqrt(l1 + l2 + l3) (Cauchy-Schwarz), and stays below 2^30 steps.
PALPA_FN float steps_per_metre(uint contacts, float l1, float l2, float l3) {
  PALPA_EXACT float reach = float(contacts) * sqrt(l1 + l2 + l3);
  PALPA_EXACT float steps = 1.0e9f / reach;
  return steps;
}

PALPA_FN int in_steps(float metres, float steps) {
  PALPA_EXACT float scaled_up = metres * steps;
  return int(floor(scaled_up + 0.5f));
}

// The mean is the centroid relative to the origin, so that a position is rounded only once.
PALPA_FN float focus_coordinate(float origin, float mean, int sum, uint points, float steps) {
  PALPA_EXACT float offset = float(sum) / (float(points) * steps);
  PALPA_EXACT float coordinate = origin + (mean + offset);
  return coordinate;
}

// ---- equal arc lengths ----

// Radii in Eq. (5)'s scaled plane are also summed in integers. Their sum is at most contacts * sqrt(2).
PALPA_FN float radius_steps(uint contacts) {
  PALPA_EXACT float steps = 7.0e8f / float(contacts);
  return steps;
}

PALPA_FN float radius_of(Float2 p) {
  PALPA_EXACT float radius = sqrt(p.x * p.x + p.y * p.y);
  return radius;
}

PALPA_FN float mean_radius(int sum, uint points, float steps) {
  PALPA_EXACT float mean = float(sum) / (float(points) * steps);
  return mean;
}

// An empty bin's radius: between those of the nearest bins that have one, `back` and `on` bins away.
PALPA_FN float radius_between(float before, float after, uint back, uint on) {
  PALPA_EXACT float radius = (before * float(on) + after * float(back)) / float(back + on);
  return radius;
}

// A corner lies where two bins meet; its radius is smoothed over four bins.
PALPA_FN Float2 corner_of(float r0, float r1, float r2, float r3, Float2 direction) {
  PALPA_EXACT float radius = (r0 + 3.0f * r1 + 3.0f * r2 + r3) * 0.125f;
  PALPA_EXACT Float2 corner;
  corner.x = radius * direction.x;
  corner.y = radius * direction.y;
  return corner;
}

// The distance in metres between two points of the scaled plane.
PALPA_FN float metres_between(Float2 a, Float2 b, Scaling scaling) {
  PALPA_EXACT float x = b.x - a.x;
  PALPA_EXACT float y = b.y - a.y;
  PALPA_EXACT float u = scaling.back_xx * x - scaling.back_xy * y;
  PALPA_EXACT float v = scaling.back_xy * x - scaling.back_yy * y;
  PALPA_EXACT float metres = sqrt(u * u + v * v);
  return metres;
}

// The point `ahead` beyond a on the way to b; the way's length is `side`.
PALPA_FN Float2 along_side(Float2 a, Float2 b, float ahead, float side) {
  PALPA_EXACT float share = side > 0.0f ? ahead / side : 0.0f;
  PALPA_EXACT Float2 r;
  r.x = a.x + share * (b.x - a.x);
  r.y = a.y + share * (b.y - a.y);
  return r;
}

// The distance along an outline of that length at which piece n of `count` begins.
PALPA_FN float cut_at(float outline, uint n, uint count) {
  PALPA_EXACT float at = outline * float(n) / float(count);
  return at;
}

PALPA_SHADER_END
#endif
