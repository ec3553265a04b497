// The arithmetic of following fingers, for follow.comp and its twin; see exact_math.h. The rules are in docs/touch.md.
#ifndef PALPA_SHADERS_FOLLOW_MATH_H
#define PALPA_SHADERS_FOLLOW_MATH_H
#include "sections_math.h"

#ifdef __cplusplus
#define PALPA_FLOAT inline constexpr float
#else
#define PALPA_FLOAT const float
#endif
PALPA_SHADER_BEGIN

// A finger that nobody sees is remembered that long, one that has merged into another's cluster longer.
PALPA_CONST memory_us = 300000u;
PALPA_CONST merged_memory_us = 1000000u;
// An unseen finger is believed to move on that long.
PALPA_CONST coasting_us = 100000u;

PALPA_FLOAT near_m = 0.009f;        // a finger is found that near to where it is expected,
PALPA_FLOAT surprise_mps = 1.0f;    // and so much farther per second since the frame before: 20 mm at 90 Hz
PALPA_FLOAT drift_mps = 0.05f;      // and per second that it went unseen
PALPA_FLOAT velocity_s = 0.03f;     // velocities follow within that time
PALPA_FLOAT new_finger = 2.0f;      // cost of taking a finger for a new one, in squared reaches
PALPA_FLOAT second_class = 1.0f;    // a candidate that was not seen in the frame before yields to one that was
PALPA_FLOAT out_of_reach = 1.0e6f;  // a cost that is never paid
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

// How far from where it is expected a finger may be found.
PALPA_FN float reach_of(float frame_s, float unseen_s, float stray) {
  PALPA_EXACT float reach = near_m + surprise_mps * frame_s + drift_mps * unseen_s + stray;
  return reach;
}

// Cost of taking the finger at `found` for the track expected at `place`: the squared distance, in reaches of a track
// that was just seen; out_of_reach if it is farther than the track's own reach.
PALPA_FN float follow_cost(Float3 found, Float3 place, float reach, float scale, float penalty) {
  const Float3 apart = minus(found, place);
  const float square = dot3(apart, apart);
  PALPA_EXACT float most = reach * reach;
  PALPA_EXACT float cost = square / (scale * scale) + penalty;
  return square > most ? out_of_reach : cost;
}

// Turns a found difference into a change of velocity: divided by the time it took, and by velocity_s more.
PALPA_FN float velocity_gain(float over_s) {
  PALPA_EXACT float gain = 1.0f / (over_s + velocity_s);
  return gain;
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

// Whether a cluster of this spread looks like more than the one finger that it was.
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

// What the shape of a cluster of two fingers says of the way from one to the other. The cluster's covariance is that of
// the two alone plus share_a share_b r r^T; one step of power iteration from the expected r gives r with its sign kept.
struct Parting {
  Float3 correction;  // to the expected r
  float trust;        // 0: the two are too near each other to be told apart; 1: clearly apart
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

PALPA_FLOAT round_below = 0.1f;      // (l1 - l2) / (l1 + l2) of a cross-section without a preferred direction
PALPA_FLOAT long_above = 0.5f;       // of one whose axes are the principal ones
PALPA_FLOAT settling_s = 0.1f;       // how slowly axes settle half way between
PALPA_FLOAT most_turn_per_s = 5.0f;  // radians; in the plane

struct Steady {
  Axes axes;           // w1 and w2 turned, eigenvalues still those of the principal directions
  float cosine, sine;  // the first principal direction in coordinates of w1 and w2
};

// The old frame carried over by the smallest rotation that takes old w3 to the new one (its sign the one nearer to the
// old), then turned in the plane towards the principal direction as far as the cross-section is elongated.
PALPA_FN Steady steady_axes(Axes principal, Float3 old1, Float3 old3, float frame_s) {
  Float3 w3 = principal.w3;
  if (dot3(w3, old3) < 0.0f) w3 = scaled(w3, -1.0f);
  const Float3 both = moved(w3, old3, 1.0f);
  PALPA_EXACT float factor = -(dot3(w3, old1) / (1.0f + dot3(w3, old3)));
  Float3 carried = moved(old1, both, factor);
  carried = unit(moved(carried, w3, -dot3(carried, w3)));
  const Float3 across = cross3(w3, carried);

  float c = dot3(principal.w1, carried);
  float s = dot3(principal.w1, across);
  if (c < 0.0f) {  // the nearer of the two directions
    c = -c;
    s = -s;
  }
  const float sum = principal.l1 + principal.l2;
  PALPA_EXACT float elongation = sum > 0.0f ? (principal.l1 - principal.l2) / sum : 0.0f;
  PALPA_EXACT float beyond = frame_s * (elongation - round_below);
  PALPA_EXACT float missing = settling_s * (long_above - elongation);
  PALPA_EXACT float quick = beyond / (beyond + missing);
  const float share = elongation <= round_below || !(beyond > 0.0f) ? 0.0f : (elongation >= long_above ? 1.0f : quick);
  PALPA_EXACT float ahead = 1.0f - share + share * c;
  PALPA_EXACT float aside = share * s;
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

  Steady r;
  r.axes = principal;
  r.axes.w3 = w3;
  Float3 w1 = moved(scaled(carried, cosine), across, sine);
  r.axes.w1 = unit(moved(w1, w3, -dot3(w1, w3)));
  r.axes.w2 = cross3(w3, r.axes.w1);
  const float c1 = dot3(principal.w1, r.axes.w1);
  const float s1 = dot3(principal.w1, r.axes.w2);
  PALPA_EXACT float norm = 1.0f / sqrt(c1 * c1 + s1 * s1);
  r.cosine = product(c1, norm);
  r.sine = product(s1, norm);
  return r;
}

PALPA_SHADER_END
#endif
