// The arithmetic that decides how far a point is from a triangle and on which side of the surface it lies. The shader,
// its twin and the code that makes the cells include it, so all give the same answer. See exact_math.h for the rules.
#ifndef PALPA_SHADERS_SURFACE_MATH_H
#define PALPA_SHADERS_SURFACE_MATH_H
#include "shaders/shared/exact_math.h"
#include "shaders/touch/contacts/surface.h"
PALPA_SHADER_BEGIN

// A point in a triangle's own axes, from the start of its first side.
struct OnAxes {
  float along, across, above;
};

PALPA_FN OnAxes on_axes(SurfaceTriangle t, Float3 p) {
  Float3 normal, along;
  PALPA_EXACT Float3 r;
  r.x = p.x - t.corner.x;
  r.y = p.y - t.corner.y;
  r.z = p.z - t.corner.z;
  normal.x = t.normal.x;
  normal.y = t.normal.y;
  normal.z = t.normal.z;
  along.x = t.along.x;
  along.y = t.along.y;
  along.z = t.along.z;
  OnAxes on;
  on.along = dot3(along, r);
  on.across = dot3(cross3(normal, along), r);
  on.above = dot3(normal, r);
  return on;
}

// A point's place relative to a side: the distance out of the triangle, and the distance along the side from its start.
struct ToSide {
  float out_of, along;
};

PALPA_FN ToSide to_side0(OnAxes on) {
  ToSide to;
  to.out_of = -on.across;
  to.along = on.along;
  return to;
}
PALPA_FN ToSide to_side1(SurfaceTriangle t, OnAxes on) {
  PALPA_EXACT float from = on.along - t.corner.w;
  PALPA_EXACT float out_of = from * t.along.w - on.across * t.normal.w;
  PALPA_EXACT float along = from * t.normal.w + on.across * t.along.w;
  ToSide to;
  to.out_of = out_of;
  to.along = along;
  return to;
}
PALPA_FN ToSide to_side2(SurfaceTriangle t, OnAxes on) {
  PALPA_EXACT float out_of = on.along * t.rest.z - on.across * t.rest.y;
  PALPA_EXACT float along = (on.along * t.rest.y + on.across * t.rest.z) + t.rest.w;
  ToSide to;
  to.out_of = out_of;
  to.along = along;
  return to;
}

// The distance along a side of that length beyond the side: negative before its start, 0 beside it, positive beyond its
// end.
PALPA_FN float past_side(float along, float side) {
  PALPA_EXACT float beyond = along - side;
  return along < 0.0f ? along : (along > side ? beyond : 0.0f);
}

// The squared distance in the triangle's plane.
PALPA_FN float side_distance2(ToSide to, float side) {
  const float past = past_side(to.along, side);
  PALPA_EXACT float square = to.out_of * to.out_of + past * past;
  return square;
}

// The squared distance of a point from a triangle. A point beside the triangle's rim is treated as at a side, which
// gives the same distance.
PALPA_FN float surface_distance2(SurfaceTriangle t, Float3 p) {
  const OnAxes on = on_axes(t, p);
  const ToSide to0 = to_side0(on);
  const ToSide to1 = to_side1(t, on);
  const ToSide to2 = to_side2(t, on);
  float flat2 = side_distance2(to0, t.corner.w);
  const float flat2_1 = side_distance2(to1, t.rest.x);
  const float flat2_2 = side_distance2(to2, t.rest.w);
  flat2 = flat2_1 < flat2 ? flat2_1 : flat2;
  flat2 = flat2_2 < flat2 ? flat2_2 : flat2;
  flat2 = to0.out_of < 0.0f && to1.out_of < 0.0f && to2.out_of < 0.0f ? 0.0f : flat2;
  PALPA_EXACT float square = on.above * on.above + flat2;
  return square;
}

// The feature of a triangle that a point is nearest to. side: 0 to 2, or 3 for the face; past: as from past_side.
struct SurfaceFeature {
  uint side;
  float past, out_of;
};

PALPA_FN SurfaceFeature surface_feature(SurfaceTriangle t, OnAxes on) {
  const ToSide to0 = to_side0(on);
  const ToSide to1 = to_side1(t, on);
  const ToSide to2 = to_side2(t, on);
  const float flat2_0 = side_distance2(to0, t.corner.w);
  const float flat2_1 = side_distance2(to1, t.rest.x);
  const float flat2_2 = side_distance2(to2, t.rest.w);
  SurfaceFeature f;
  f.side = 0u;
  f.past = past_side(to0.along, t.corner.w);
  f.out_of = to0.out_of;
  float flat2 = flat2_0;
  if (flat2_1 < flat2) {
    flat2 = flat2_1;
    f.side = 1u;
    f.past = past_side(to1.along, t.rest.x);
    f.out_of = to1.out_of;
  }
  if (flat2_2 < flat2) {
    f.side = 2u;
    f.past = past_side(to2.along, t.rest.w);
    f.out_of = to2.out_of;
  }
  if (to0.out_of < 0.0f && to1.out_of < 0.0f && to2.out_of < 0.0f) f.side = 3u;
  return f;
}

// The corner that the point is nearest to, 0 to 2; 3 if it is nearest to no corner.
PALPA_FN uint feature_corner(SurfaceFeature f) {
  if (f.side == 3u || f.past == 0.0f) return 3u;
  const uint next = f.side == 2u ? 0u : f.side + 1u;
  return f.past < 0.0f ? f.side : next;
}

// Positive outside, negative inside: for a point nearest to the face or a side of the triangle.
PALPA_FN float side_sign(SurfaceFeature f, OnAxes on, uint word) {
  if (f.side == 3u) return on.above;
  const float across = float(int(word << 16u) >> 16);
  const float upwards = float(int(word) >> 16);
  PALPA_EXACT float sign = across * f.out_of + upwards * on.above;
  return sign == 0.0f ? on.above : sign;
}

// The same for a point nearest to a corner. pseudonormal.w alone decides if the surface is sharp there.
PALPA_FN float corner_sign(SurfaceTriangle t, OnAxes on, uint corner, vec4 pseudonormal) {
  Float3 normal, along, pseudo;
  normal.x = t.normal.x;
  normal.y = t.normal.y;
  normal.z = t.normal.z;
  along.x = t.along.x;
  along.y = t.along.y;
  along.z = t.along.z;
  pseudo.x = pseudonormal.x;
  pseudo.y = pseudonormal.y;
  pseudo.z = pseudonormal.z;
  // From the corner, in the triangle's axes.
  float a = on.along;
  float c = on.across;
  if (corner == 1u) {
    PALPA_EXACT float from = on.along - t.corner.w;
    a = from;
  }
  if (corner == 2u) {
    PALPA_EXACT float from_along = on.along + t.rest.w * t.rest.y;
    PALPA_EXACT float from_across = on.across + t.rest.w * t.rest.z;
    a = from_along;
    c = from_across;
  }
  PALPA_EXACT float sign = a * dot3(pseudo, along) + c * dot3(pseudo, cross3(normal, along)) +
                           on.above * dot3(pseudo, normal) + pseudonormal.w;
  return sign;
}

PALPA_SHADER_END
#endif
