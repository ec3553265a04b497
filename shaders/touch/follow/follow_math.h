// The arithmetic of following fingers, for follow.comp and its twin; see exact_math.h. The rules are in docs/touch.md.
#ifndef PALPA_SHADERS_FOLLOW_MATH_H
#define PALPA_SHADERS_FOLLOW_MATH_H
#include "shaders/touch/follow/follow.h"
#include "shaders/touch/sections/sections_math.h"

#ifdef __cplusplus
#define PALPA_FLOAT inline constexpr float
#else
#define PALPA_FLOAT const float
#endif
PALPA_SHADER_BEGIN

// A finger that has merged into another's cluster is remembered for this time.
PALPA_CONST merged_memory_us = 1000000u;
// An unseen finger is assumed to move on for this time.
PALPA_CONST coasting_us = 100000u;

PALPA_FLOAT near_m = 0.009f;        // a finger is found within this distance of where it is expected,
PALPA_FLOAT surprise_mps = 1.0f;    // plus this much per second since the frame before: 20 mm at 90 Hz,
PALPA_FLOAT drift_mps = 0.05f;      // plus this much per second that it was not seen
PALPA_FLOAT velocity_s = 0.03f;     // velocities adapt within this time
PALPA_FLOAT new_finger = 2.0f;      // cost of taking a finger for a new one, in squared reaches
PALPA_FLOAT second_class = 1.0f;    // a candidate that was not seen in the frame before yields to one that was
PALPA_FLOAT out_of_reach = 1.0e6f;  // marks a pair that is never matched
PALPA_FLOAT no_cost_yet = 1.0e9f;

PALPA_FN float in_seconds(uint us) {
  PALPA_EXACT float s = float(us) * 1.0e-6f;
  return s;
}

PALPA_FN uint later(uint us, uint elapsed_us) {
  return us > 0xffffffffu - elapsed_us ? 0xffffffffu : us + elapsed_us;
}

// a + b * factor
PALPA_FN Float3 moved(Float3 a, Float3 b, float factor) {
  PALPA_EXACT Float3 r;
  r.x = a.x + b.x * factor;
  r.y = a.y + b.y * factor;
  r.z = a.z + b.z * factor;
  return r;
}

// The largest distance of a finger from where it is expected.
PALPA_FN float reach_of(float frame_s, float unseen_s, float stray) {
  PALPA_EXACT float reach = near_m + surprise_mps * frame_s + drift_mps * unseen_s + stray;
  return reach;
}

// Cost of matching the finger at `found` with the track expected at `place`: the squared distance, in reaches of a
// track that was just seen; out_of_reach if it is farther than the track's own reach.
PALPA_FN float follow_cost(Float3 found, Float3 place, float reach, float scale, float penalty) {
  const Float3 apart = minus(found, place);
  const float square = dot3(apart, apart);
  PALPA_EXACT float most = reach * reach;
  PALPA_EXACT float cost = square / (scale * scale) + penalty;
  return square > most ? out_of_reach : cost;
}

// Factor from a position error to a change of velocity: 1 / (the time that the error took + velocity_s). Two frames of
// the same time give no change.
PALPA_FN float velocity_gain(float over_s) {
  PALPA_EXACT float gain = 1.0f / (over_s + velocity_s);
  return over_s > 0.0f ? gain : 0.0f;
}

PALPA_FN uint memory_of(bool carried, uint memory_us) {
  return carried && merged_memory_us > memory_us ? merged_memory_us : memory_us;
}

// Whether a finger's foci may continue from where they were: the finger was in the frame before, however long ago that
// is, or was missing for no longer than it coasts, and the data kept of its foci is its own.
PALPA_FN bool glides_on(uint flags, uint unseen_us, uint since_us) {
  return (flags & track_left_home) == 0u && (unseen_us == 0u || since_us <= coasting_us);
}

// ---- merged clusters ----

PALPA_FN Sym3 covariance_of(Axes a) {
  PALPA_EXACT Sym3 m;
  m.xx = a.l1 * a.w1.x * a.w1.x + a.l2 * a.w2.x * a.w2.x + a.l3 * a.w3.x * a.w3.x;
  m.xy = a.l1 * a.w1.x * a.w1.y + a.l2 * a.w2.x * a.w2.y + a.l3 * a.w3.x * a.w3.y;
  m.xz = a.l1 * a.w1.x * a.w1.z + a.l2 * a.w2.x * a.w2.z + a.l3 * a.w3.x * a.w3.z;
  m.yy = a.l1 * a.w1.y * a.w1.y + a.l2 * a.w2.y * a.w2.y + a.l3 * a.w3.y * a.w3.y;
  m.yz = a.l1 * a.w1.y * a.w1.z + a.l2 * a.w2.y * a.w2.z + a.l3 * a.w3.y * a.w3.z;
  m.zz = a.l1 * a.w1.z * a.w1.z + a.l2 * a.w2.z * a.w2.z + a.l3 * a.w3.z * a.w3.z;
  return m;
}

PALPA_FN float trace_of(Sym3 m) {
  PALPA_EXACT float trace = m.xx + m.yy + m.zz;
  return trace;
}

PALPA_FN Float3 times(Sym3 m, Float3 v) {
  PALPA_EXACT Float3 r;
  r.x = m.xx * v.x + m.xy * v.y + m.xz * v.z;
  r.y = m.xy * v.x + m.yy * v.y + m.yz * v.z;
  r.z = m.xz * v.x + m.yz * v.y + m.zz * v.z;
  return r;
}

// Whether a cluster of this spread looks like more than one finger, whose spread alone was `alone`.
PALPA_FN bool looks_merged(Sym3 cluster, Sym3 alone) {
  PALPA_EXACT float most = 1.3f * trace_of(alone);
  return trace_of(cluster) > most;
}

// Squared distance from a cluster's centroid in units of its ellipsoid: two standard deviations and 4 mm.
PALPA_FN float inside_square(Axes a, Float3 from_centroid) {
  PALPA_EXACT float s1 = 2.0f * sqrt(a.l1) + 0.004f;
  PALPA_EXACT float s2 = 2.0f * sqrt(a.l2) + 0.004f;
  PALPA_EXACT float s3 = 2.0f * sqrt(a.l3) + 0.004f;
  PALPA_EXACT float e1 = dot3(a.w1, from_centroid) / s1;
  PALPA_EXACT float e2 = dot3(a.w2, from_centroid) / s2;
  PALPA_EXACT float e3 = dot3(a.w3, from_centroid) / s3;
  PALPA_EXACT float square = e1 * e1 + e2 * e2 + e3 * e3;
  return square;
}

// Keeps a merged finger within its cluster: at most 0.8 of the ellipsoid from the centroid.
PALPA_FN Float3 kept_inside(Axes a, Float3 from_centroid) {
  const float square = inside_square(a, from_centroid);
  if (square <= 0.64f) return from_centroid;
  PALPA_EXACT float factor = 0.8f / sqrt(square);
  return scaled(from_centroid, factor);
}

// The estimate of the way from one finger to the other from the shape of their cluster. The cluster's covariance is
// that of the two alone plus share_a share_b r r^T. One step of power iteration from the expected r gives r with its
// sign kept.
struct Parting {
  Float3 correction;  // to the expected r
  float trust;        // 0: the two are too near to be distinguished; 1: clearly apart
};

PALPA_FN Parting parting_of(Sym3 cluster, Sym3 a, Sym3 b, float share_a, float share_b, Float3 expected) {
  PALPA_EXACT Sym3 excess;
  excess.xx = cluster.xx - share_a * a.xx - share_b * b.xx;
  excess.xy = cluster.xy - share_a * a.xy - share_b * b.xy;
  excess.xz = cluster.xz - share_a * a.xz - share_b * b.xz;
  excess.yy = cluster.yy - share_a * a.yy - share_b * b.yy;
  excess.yz = cluster.yz - share_a * a.yz - share_b * b.yz;
  excess.zz = cluster.zz - share_a * a.zz - share_b * b.zz;
  PALPA_EXACT float single = 0.5f * (share_a * trace_of(a) + share_b * trace_of(b));
  Parting parting;
  parting.correction = scaled(expected, 0.0f);
  parting.trust = 0.0f;
  const float length_square = dot3(expected, expected);
  if (!(length_square > 1.0e-12f) || !(single > 0.0f)) return parting;
  const Float3 along = times(excess, expected);
  PALPA_EXACT float variance = dot3(expected, along) / length_square;
  if (!(variance > 0.0f)) return parting;
  PALPA_EXACT float factor = 1.0f / sqrt(share_a * share_b * variance * length_square);
  const Float3 seen = scaled(along, factor);
  PALPA_EXACT float trust = dot3(seen, seen) / single - 1.0f;
  parting.trust = trust < 0.0f ? 0.0f : (trust > 1.0f ? 1.0f : trust);
  parting.correction = minus(seen, expected);
  return parting;
}

// ---- steady axes ----

PALPA_FLOAT clear_below = 0.15f;     // l3 / l2 of a cross-section whose contacts alone show where it faces,
PALPA_FLOAT unclear_above = 0.5f;    // and of one for which depth shows it
PALPA_FLOAT facing_s = 0.15f;        // how slowly w3 settles in that case
PALPA_FLOAT steep = 0.1f;            // a gradient of depth that is reliable
PALPA_FLOAT round_below = 0.1f;      // (l1 - l2) / (l1 + l2) of a cross-section without a preferred direction
PALPA_FLOAT long_above = 0.5f;       // of one whose axes are the principal axes
PALPA_FLOAT settling_s = 0.1f;       // how slowly axes settle half way between the two
PALPA_FLOAT most_turn_per_s = 5.0f;  // radians; for w3, and for w1 in the plane

struct Steady {
  Axes axes;           // eigenvalues: variances along the principal directions of the plane, and along w3
  float cosine, sine;  // the first of these directions, in coordinates of w1 and w2
};

PALPA_FN Float3 nearer(Float3 axis, Float3 before) {
  return dot3(axis, before) < 0.0f ? scaled(axis, -1.0f) : axis;
}

PALPA_FN float slope_along(Float3 w, float variance, Float3 lean) {
  PALPA_EXACT float slope = dot3(w, lean) / (variance + 1.0e-8f);  // a spread of 0.1 mm gives no gradient
  return slope;
}

// The depth's gradient over the contacts: that of the linear function that fits their depths best. On a plane, whatever
// part of it is touched, it is the plane's normal, of length 1. On several faces, it lies between their normals.
PALPA_FN Float3 depth_gradient(Axes a, Float3 lean) {
  Float3 gradient = scaled(a.w1, slope_along(a.w1, a.l1, lean));
  gradient = moved(gradient, a.w2, slope_along(a.w2, a.l2, lean));
  return moved(gradient, a.w3, slope_along(a.w3, a.l3, lean));
}

// How clearly the contacts alone show where a cross-section faces: 1 if they have a thinnest direction, 0 if two
// eigenvalues are close.
PALPA_FN float clearness_of(Axes a) {
  PALPA_EXACT float thickness = a.l2 > 0.0f ? a.l3 / a.l2 : 0.0f;
  PALPA_EXACT float clearness = (unclear_above - thickness) / (unclear_above - clear_below);
  return clearness < 0.0f ? 0.0f : (clearness > 1.0f ? 1.0f : clearness);
}

// The direction in which a cross-section faces that faced `before`: the principal w3 if it is clear, else the depth's
// gradient. If depth hardly changes with place, the direction stays as before.
PALPA_FN Float3 facing_of(Axes principal, Float3 lean, Float3 before) {
  const float clear = clearness_of(principal);
  const Float3 w3 = nearer(principal.w3, before);
  if (clear >= 1.0f) return w3;
  const Float3 gradient = nearer(depth_gradient(principal, lean), before);
  PALPA_EXACT float length = sqrt(dot3(gradient, gradient));
  PALPA_EXACT float most = length / steep;
  const float trust = most < 1.0f ? most : 1.0f;
  PALPA_EXACT float rest = 1.0f - trust;
  PALPA_EXACT float along = length > 0.0f ? trust / length : 0.0f;
  const Float3 by_depth = moved(scaled(before, rest), gradient, along);
  PALPA_EXACT float unclear = 1.0f - clear;
  const Float3 facing = moved(scaled(w3, clear), by_depth, unclear);
  return dot3(facing, facing) > 1.0e-6f ? unit(facing) : before;
}

// In a cross-section's plane: the variances along its principal directions, and the first direction in coordinates of
// two axes, with the sign that makes cosine >= 0.
struct Principal2 {
  float l1, l2;
  float cosine, sine;
};

PALPA_FN Principal2 principal_in_plane(Sym3 m, Float3 w1, Float3 w2) {
  const Float3 m1 = times(m, w1);
  const Float3 m2 = times(m, w2);
  const float xx = dot3(w1, m1);
  const float xy = dot3(w1, m2);
  const float yy = dot3(w2, m2);
  PALPA_EXACT float middle = 0.5f * (xx + yy);
  PALPA_EXACT float apart = 0.5f * (xx - yy);
  PALPA_EXACT float radius = sqrt(apart * apart + xy * xy);
  PALPA_EXACT float l1 = middle + radius;
  PALPA_EXACT float l2 = middle - radius;
  PALPA_EXACT float least = 1.0e-6f * l1;  // as in is_point_like
  Principal2 r;
  r.l1 = l1;
  r.l2 = l2 > least ? l2 : least;
  r.cosine = 1.0f;
  r.sine = 0.0f;
  if (!(radius > 0.0f)) return r;
  // Cosine and sine of twice the angle.
  PALPA_EXACT float cosine2 = apart / radius;
  PALPA_EXACT float sine2 = xy / radius;
  if (cosine2 >= 0.0f) {
    PALPA_EXACT float cosine = sqrt(0.5f * (1.0f + cosine2));
    PALPA_EXACT float sine = 0.5f * sine2 / cosine;
    r.cosine = cosine;
    r.sine = sine;
  } else {
    PALPA_EXACT float sine = sqrt(0.5f * (1.0f - cosine2));
    PALPA_EXACT float cosine = 0.5f * abs(sine2) / sine;
    r.cosine = cosine;
    r.sine = sine2 < 0.0f ? -sine : sine;
  }
  return r;
}

// The axes of the plane across w3; w1 is `carried` turned by (cosine, sine).
PALPA_FN Steady axes_across(Sym3 covariance, Principal2 plane, Float3 w3, Float3 carried, Float3 across, float cosine,
                            float sine) {
  Steady r;
  r.axes.w3 = w3;
  const Float3 w1 = moved(scaled(carried, cosine), across, sine);
  r.axes.w1 = unit(moved(w1, w3, -dot3(w1, w3)));
  r.axes.w2 = cross3(w3, r.axes.w1);
  r.axes.l1 = plane.l1;
  r.axes.l2 = plane.l2;
  const float l3 = dot3(w3, times(covariance, w3));
  r.axes.l3 = l3 > 0.0f ? l3 : 0.0f;
  const Float3 first = moved(scaled(carried, plane.cosine), across, plane.sine);
  const float c1 = dot3(first, r.axes.w1);
  const float s1 = dot3(first, r.axes.w2);
  PALPA_EXACT float norm = 1.0f / sqrt(c1 * c1 + s1 * s1);
  r.cosine = product(c1, norm);
  r.sine = product(s1, norm);
  return r;
}

// For a finger without an earlier frame: the principal axes, unless depth shows better where they face. Signs as
// theirs.
PALPA_FN Steady first_axes(Axes principal, Float3 lean) {
  Steady r;
  r.axes = principal;
  r.cosine = 1.0f;
  r.sine = 0.0f;
  if (clearness_of(principal) >= 1.0f) return r;
  const Float3 w3 = upwards(facing_of(principal, lean, principal.w3));
  Float3 carried = moved(principal.w1, w3, -dot3(principal.w1, w3));
  if (dot3(carried, carried) < 1.0e-4f) carried = moved(principal.w2, w3, -dot3(principal.w2, w3));
  carried = unit(carried);
  const Float3 across = cross3(w3, carried);
  const Sym3 covariance = covariance_of(principal);
  const Principal2 plane = principal_in_plane(covariance, carried, across);
  const Float3 w1 = moved(scaled(carried, plane.cosine), across, plane.sine);
  const float sign = largest_component(w1) < 0.0f ? -1.0f : 1.0f;
  return axes_across(covariance, plane, w3, carried, across, product(sign, plane.cosine), product(sign, plane.sine));
}

// `old` turned towards a direction by a share of the angle, at most by most_turn_per_s.
PALPA_FN Float3 turned_towards(Float3 old, Float3 direction, float share, float frame_s) {
  const Float3 way = minus(direction, old);
  PALPA_EXACT float chord = sqrt(dot3(way, way));
  PALPA_EXACT float wanted = share * chord;
  PALPA_EXACT float most = most_turn_per_s * frame_s;
  if (!(wanted > most)) return unit(moved(old, way, share));
  PALPA_EXACT float factor = most / chord;
  return unit(moved(old, way, factor));
}

// w3 turns towards the direction in which the cross-section faces, at once if that is clear. The old w1 is carried over
// by the smallest rotation that takes the old w3 to the new one. It is then turned in the plane towards the nearer of
// the principal directions, the more elongated the cross-section, the farther.
PALPA_FN Steady steady_axes(Axes principal, Float3 lean, Float3 old1, Float3 old3, float frame_s) {
  PALPA_EXACT float slowness = facing_s * (1.0f - clearness_of(principal));
  PALPA_EXACT float settled = frame_s / (frame_s + slowness);
  const float settling = slowness > 0.0f ? settled : 1.0f;
  const Float3 w3 = turned_towards(old3, facing_of(principal, lean, old3), settling, frame_s);
  const Float3 both = moved(w3, old3, 1.0f);
  PALPA_EXACT float factor = -(dot3(w3, old1) / (1.0f + dot3(w3, old3)));
  Float3 carried = moved(old1, both, factor);
  carried = unit(moved(carried, w3, -dot3(carried, w3)));
  const Float3 across = cross3(w3, carried);

  const Sym3 covariance = covariance_of(principal);
  const Principal2 plane = principal_in_plane(covariance, carried, across);
  PALPA_EXACT float sum = plane.l1 + plane.l2;
  PALPA_EXACT float elongation = sum > 0.0f ? (plane.l1 - plane.l2) / sum : 0.0f;
  PALPA_EXACT float beyond = frame_s * (elongation - round_below);
  PALPA_EXACT float missing = settling_s * (long_above - elongation);
  PALPA_EXACT float quick = beyond / (beyond + missing);
  const float share = elongation <= round_below || !(beyond > 0.0f) ? 0.0f : (elongation >= long_above ? 1.0f : quick);
  PALPA_EXACT float ahead = 1.0f - share + share * plane.cosine;
  PALPA_EXACT float aside = share * plane.sine;
  PALPA_EXACT float chord = sqrt(ahead * ahead + aside * aside);
  PALPA_EXACT float sine = aside / chord;
  PALPA_EXACT float cosine = ahead / chord;
  PALPA_EXACT float allowed = most_turn_per_s * frame_s;
  const float most = allowed < 0.7f ? allowed : 0.7f;
  PALPA_EXACT float rest = sqrt(1.0f - most * most);
  if (abs(sine) > most) {
    sine = sine < 0.0f ? -most : most;
    cosine = rest;
  }
  return axes_across(covariance, plane, w3, carried, across, cosine, sine);
}

PALPA_SHADER_END
#endif
