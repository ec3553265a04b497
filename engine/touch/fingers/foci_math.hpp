// The arithmetic of foci, Eq. (5)-(7).
#pragma once

#include <cmath>
#include <cstdint>

#include "touch/fingers/exact.hpp"
#include "touch/fingers/sections_math.hpp"

namespace palpa::touch {

inline constexpr std::uint32_t foci_most = 64U;

/// Number of corners of the outline of a cross-section, at equal angles.
inline constexpr std::uint32_t outline_bins = 64U;

struct Border {
  float x;
  float y;
};

/// Eq. (5)'s scaling to equal variance and back, as symmetric matrices, for in-plane axes w1 and w2. In their
/// coordinates, the first principal direction is (cosine, sine). For the principal axes themselves, they are Eq. (5)'s
/// 1 / std::sqrt(l).
struct Scaling {
  float xx, xy, yy;
  float back_xx, back_xy, back_yy;
};

inline Scaling scaling_of(float l1, float l2, float cosine, float sine) {
  float root1 = std::sqrt(l1);
  float root2 = std::sqrt(l2);
  float scale1 = 1.0F / root1;
  float scale2 = 1.0F / root2;
  Scaling r;
  r.xx = scale1 * cosine * cosine + scale2 * sine * sine;
  r.xy = (scale1 - scale2) * cosine * sine;
  r.yy = scale1 * sine * sine + scale2 * cosine * cosine;
  r.back_xx = root1 * cosine * cosine + root2 * sine * sine;
  r.back_xy = (root1 - root2) * cosine * sine;
  r.back_yy = root1 * sine * sine + root2 * cosine * cosine;
  return r;
}

/// Eq. (5) with its second coordinate negated: angles of (x, y) run clockwise seen from the tip of w3, so y counts
/// against w2.
inline Float2 on_plane(PrincipalAxes axes, Float3 from_centroid, Scaling scaling) {
  const float x = dot3(axes.w1, from_centroid);
  const float y = dot3(axes.w2, from_centroid);
  Float2 r;
  r.x = x * scaling.xx + y * scaling.xy;
  r.y = -(x * scaling.xy + y * scaling.yy);
  return r;
}

/// Angles in [pi, 2 pi).
inline bool in_second_half(Float2 p) {
  return p.y < 0.0F || (p.y == 0.0F && p.x < 0.0F);
}

/// Whether p's angle is at least the border's, both in [0, 2 pi). It uses no arctangent, so devices cannot disagree
/// about its last digits.
inline bool reaches(Float2 p, Float2 border) {
  const bool second = in_second_half(p);
  const bool border_second = in_second_half(border);
  float turn = border.x * p.y - border.y * p.x;
  return second == border_second ? turn >= 0.0F : second;
}

/// Sector sums are integers, so their order does not matter. The steps are as fine as 31 bits allow: the sum of all
/// distances from the centroid is at most contacts * std::sqrt(l1 + l2 + l3) (Cauchy-Schwarz), and stays below 2^30
/// steps.
inline float steps_per_metre(std::uint32_t contacts, float l1, float l2, float l3) {
  float reach = float(contacts) * std::sqrt(l1 + l2 + l3);
  float steps = 1.0e9F / reach;
  return steps;
}

inline int in_steps(float metres, float steps) {
  float scaled_up = metres * steps;
  return int(std::floor(scaled_up + 0.5F));
}

/// The mean is the centroid relative to the origin, so that a position is rounded only once.
inline float focus_coordinate(float origin, float mean, int sum, std::uint32_t points, float steps) {
  float offset = float(sum) / (float(points) * steps);
  float coordinate = origin + (mean + offset);
  return coordinate;
}

// ---- equal arc lengths ----

/// Radii in Eq. (5)'s scaled plane are also summed in integers. Their sum is at most contacts * std::sqrt(2).
inline float radius_steps(std::uint32_t contacts) {
  float steps = 7.0e8F / float(contacts);
  return steps;
}

inline float radius_of(Float2 p) {
  float radius = std::sqrt(p.x * p.x + p.y * p.y);
  return radius;
}

inline float mean_radius(int sum, std::uint32_t points, float steps) {
  float mean = float(sum) / (float(points) * steps);
  return mean;
}

/// An empty bin's radius: between those of the nearest bins that have one, `back` and `on` bins away.
inline float radius_between(float before, float after, std::uint32_t back, std::uint32_t on) {
  float radius = (before * float(on) + after * float(back)) / float(back + on);
  return radius;
}

/// A corner lies where two bins meet; its radius is smoothed over four bins.
inline Float2 corner_of(float r0, float r1, float r2, float r3, Float2 direction) {
  float radius = (r0 + 3.0F * r1 + 3.0F * r2 + r3) * 0.125F;
  Float2 corner;
  corner.x = radius * direction.x;
  corner.y = radius * direction.y;
  return corner;
}

/// The distance in metres between two points of the scaled plane.
inline float metres_between(Float2 a, Float2 b, Scaling scaling) {
  float x = b.x - a.x;
  float y = b.y - a.y;
  float u = scaling.back_xx * x - scaling.back_xy * y;
  float v = scaling.back_xy * x - scaling.back_yy * y;
  float metres = std::sqrt(u * u + v * v);
  return metres;
}

/// The point `ahead` beyond a on the way to b; the way's length is `side`.
inline Float2 along_side(Float2 a, Float2 b, float ahead, float side) {
  float share = side > 0.0F ? ahead / side : 0.0F;
  Float2 r;
  r.x = a.x + share * (b.x - a.x);
  r.y = a.y + share * (b.y - a.y);
  return r;
}

/// The distance along an outline of that length at which piece n of `count` begins.
inline float cut_at(float outline, std::uint32_t n, std::uint32_t count) {
  float at = outline * float(n) / float(count);
  return at;
}

}  // namespace palpa::touch
