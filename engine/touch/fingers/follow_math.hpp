// The arithmetic of following fingers. The rules are in docs/touch-frames.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "touch/fingers/exact.hpp"
#include "touch/fingers/sections_math.hpp"

namespace palpa::touch {

inline constexpr std::uint32_t follow_most_tracks = 128U;
inline constexpr std::uint32_t follow_none = 0xffffffffU;

/// As the time since the frame before: there is no frame before this one, and no id has been given. In Track::since_us:
/// the finger is new, was in another's cluster since it was last seen by itself, or was missing for longer than it
/// coasts.
inline constexpr std::uint32_t follow_restart = 0xffffffffU;

/// Bits of Track::flags.
inline constexpr std::uint32_t track_has_axes = 1U;
inline constexpr std::uint32_t track_left_home =
    2U;  // it has been in another's cluster since it was last seen by itself

/// The data on a finger, present or past. The first tracks are those of the frame's fingers, in their order.
struct Track {
  std::uint32_t id;
  std::uint32_t solid;
  std::uint32_t carrier;    // the track into whose cluster this one has merged, or follow_none
  std::uint32_t unseen_us;  // since it was last seen, by itself or in a cluster that looks like two fingers
  std::uint32_t contacts;   // when it was last seen by itself
  std::uint32_t flags;
  std::uint32_t home;  // 0 to follow_most_tracks - 1, fixed as long as the track is known: its foci's data are there
  std::uint32_t since_us;  // of this frame's fingers: time since it was last seen by itself, or follow_restart
  shader::vec4 place;      // where its centroid is, or is expected; w: its distance from the centroid of its cluster
  shader::vec4 velocity;   // m/s
  shader::vec4 axis1;      // steady w1
  shader::vec4 axis3;      // steady w3
  shader::vec4 spread_a;   // covariance when last seen by itself: xx, xy, xz, yy
  shader::vec4 spread_b;   // yz, zz
  Float3 joined;           // of this frame's fingers: how far contacts that joined or left moved its centroid
};

/// A finger that has merged into another's cluster is remembered for this time.
inline constexpr std::uint32_t merged_memory_us = 1000000U;
/// An unseen finger is assumed to move on for this time.
inline constexpr std::uint32_t coasting_us = 100000U;

inline constexpr float near_m = 0.009F;      // a finger is found within this distance of where it is expected,
inline constexpr float surprise_mps = 1.0F;  // plus this much per second since the frame before: 20 mm at 90 Hz,
inline constexpr float drift_mps = 0.05F;    // plus this much per second that it was not seen
inline constexpr float velocity_s = 0.03F;   // velocities adapt within this time
inline constexpr float new_finger = 2.0F;    // cost of taking a finger for a new one, in squared reaches
inline constexpr float second_class = 1.0F;  // a candidate that was not seen in the frame before yields to one that was
inline constexpr float out_of_reach = 1.0e6F;  // marks a pair that is never matched
inline constexpr float no_cost_yet = 1.0e9F;

/// a + b * factor
inline Float3 moved(Float3 a, Float3 b, float factor) {
  Float3 r;
  r.x = a.x + b.x * factor;
  r.y = a.y + b.y * factor;
  r.z = a.z + b.z * factor;
  return r;
}

/// The largest distance of a finger from where it is expected.
inline float reach_of(float frame_s, float unseen_s, float stray) {
  float reach = near_m + surprise_mps * frame_s + drift_mps * unseen_s + stray;
  return reach;
}

/// Cost of matching the finger at `found` with the track expected at `place`: the squared distance, in reaches of a
/// track that was just seen; out_of_reach if it is farther than the track's own reach.
inline float follow_cost(Float3 found, Float3 place, float reach, float scale, float penalty) {
  const Float3 apart = minus(found, place);
  const float square = dot3(apart, apart);
  float most = reach * reach;
  float cost = square / (scale * scale) + penalty;
  return square > most ? out_of_reach : cost;
}

/// Factor from a position error to a change of velocity: 1 / (the time that the error took + velocity_s). Two frames of
/// the same time give no change.
inline float velocity_gain(float over_s) {
  float gain = 1.0F / (over_s + velocity_s);
  return over_s > 0.0F ? gain : 0.0F;
}

inline std::uint32_t memory_of(bool carried, std::uint32_t memory_us) {
  return carried && merged_memory_us > memory_us ? merged_memory_us : memory_us;
}

/// Whether a finger's foci may continue from where they were: the finger was in the frame before, however long ago that
/// is, or was missing for no longer than it coasts, and the data kept of its foci is its own.
inline bool glides_on(std::uint32_t flags, std::uint32_t unseen_us, std::uint32_t since_us) {
  return (flags & track_left_home) == 0U && (unseen_us == 0U || since_us <= coasting_us);
}

// ---- merged clusters ----

inline Sym3 covariance_of(PrincipalAxes a) {
  Sym3 m;
  m.xx = a.l1 * a.w1.x * a.w1.x + a.l2 * a.w2.x * a.w2.x + a.l3 * a.w3.x * a.w3.x;
  m.xy = a.l1 * a.w1.x * a.w1.y + a.l2 * a.w2.x * a.w2.y + a.l3 * a.w3.x * a.w3.y;
  m.xz = a.l1 * a.w1.x * a.w1.z + a.l2 * a.w2.x * a.w2.z + a.l3 * a.w3.x * a.w3.z;
  m.yy = a.l1 * a.w1.y * a.w1.y + a.l2 * a.w2.y * a.w2.y + a.l3 * a.w3.y * a.w3.y;
  m.yz = a.l1 * a.w1.y * a.w1.z + a.l2 * a.w2.y * a.w2.z + a.l3 * a.w3.y * a.w3.z;
  m.zz = a.l1 * a.w1.z * a.w1.z + a.l2 * a.w2.z * a.w2.z + a.l3 * a.w3.z * a.w3.z;
  return m;
}

inline float trace_of(Sym3 m) {
  float trace = m.xx + m.yy + m.zz;
  return trace;
}

inline Float3 times(Sym3 m, Float3 v) {
  Float3 r;
  r.x = m.xx * v.x + m.xy * v.y + m.xz * v.z;
  r.y = m.xy * v.x + m.yy * v.y + m.yz * v.z;
  r.z = m.xz * v.x + m.yz * v.y + m.zz * v.z;
  return r;
}

/// Whether a cluster of this spread looks like more than one finger, whose spread alone was `alone`.
inline bool looks_merged(Sym3 cluster, Sym3 alone) {
  float most = 1.3F * trace_of(alone);
  return trace_of(cluster) > most;
}

/// Squared distance from a cluster's centroid in units of its ellipsoid: two standard deviations and 4 mm.
inline float inside_square(PrincipalAxes a, Float3 from_centroid) {
  float s1 = 2.0F * std::sqrt(a.l1) + 0.004F;
  float s2 = 2.0F * std::sqrt(a.l2) + 0.004F;
  float s3 = 2.0F * std::sqrt(a.l3) + 0.004F;
  float e1 = dot3(a.w1, from_centroid) / s1;
  float e2 = dot3(a.w2, from_centroid) / s2;
  float e3 = dot3(a.w3, from_centroid) / s3;
  float square = e1 * e1 + e2 * e2 + e3 * e3;
  return square;
}

/// Keeps a merged finger within its cluster: at most 0.8 of the ellipsoid from the centroid.
inline Float3 kept_inside(PrincipalAxes a, Float3 from_centroid) {
  const float square = inside_square(a, from_centroid);
  if (square <= 0.64F) return from_centroid;
  float factor = 0.8F / std::sqrt(square);
  return scaled(from_centroid, factor);
}

/// The estimate of the way from one finger to the other from the shape of their cluster. The cluster's covariance is
/// that of the two alone plus share_a share_b r r^T. One step of power iteration from the expected r gives r with its
/// sign kept.
struct Parting {
  Float3 correction;  // to the expected r
  float trust;        // 0: the two are too near to be distinguished; 1: clearly apart
};

inline Parting parting_of(Sym3 cluster, Sym3 a, Sym3 b, float share_a, float share_b, Float3 expected) {
  Sym3 excess;
  excess.xx = cluster.xx - share_a * a.xx - share_b * b.xx;
  excess.xy = cluster.xy - share_a * a.xy - share_b * b.xy;
  excess.xz = cluster.xz - share_a * a.xz - share_b * b.xz;
  excess.yy = cluster.yy - share_a * a.yy - share_b * b.yy;
  excess.yz = cluster.yz - share_a * a.yz - share_b * b.yz;
  excess.zz = cluster.zz - share_a * a.zz - share_b * b.zz;
  float single = 0.5F * (share_a * trace_of(a) + share_b * trace_of(b));
  Parting parting;
  parting.correction = scaled(expected, 0.0F);
  parting.trust = 0.0F;
  const float length_square = dot3(expected, expected);
  if (!(length_square > 1.0e-12F) || !(single > 0.0F)) return parting;
  const Float3 along = times(excess, expected);
  float variance = dot3(expected, along) / length_square;
  if (!(variance > 0.0F)) return parting;
  float factor = 1.0F / std::sqrt(share_a * share_b * variance * length_square);
  const Float3 seen = scaled(along, factor);
  float trust = dot3(seen, seen) / single - 1.0F;
  parting.trust = trust < 0.0F ? 0.0F : (trust > 1.0F ? 1.0F : trust);
  parting.correction = minus(seen, expected);
  return parting;
}

// ---- steady axes ----

inline constexpr float clear_below = 0.15F;   // l3 / l2 of a cross-section whose contacts alone show where it faces,
inline constexpr float unclear_above = 0.5F;  // and of one for which depth shows it
inline constexpr float facing_s = 0.15F;      // how slowly w3 settles in that case
inline constexpr float steep = 0.1F;          // a gradient of depth that is reliable
inline constexpr float round_below = 0.1F;    // (l1 - l2) / (l1 + l2) of a cross-section without a preferred direction
inline constexpr float long_above = 0.5F;     // of one whose axes are the principal axes
inline constexpr float settling_s = 0.1F;     // how slowly axes settle half way between the two
inline constexpr float most_turn_per_s = 5.0F;  // radians; for w3, and for w1 in the plane

struct Steady {
  PrincipalAxes axes;  // eigenvalues: variances along the principal directions of the plane, and along w3
  float cosine, sine;  // the first of these directions, in coordinates of w1 and w2
};

inline Float3 nearer(Float3 axis, Float3 before) {
  return dot3(axis, before) < 0.0F ? scaled(axis, -1.0F) : axis;
}

inline float slope_along(Float3 w, float variance, Float3 lean) {
  float slope = dot3(w, lean) / (variance + 1.0e-8F);  // a spread of 0.1 mm gives no gradient
  return slope;
}

/// The depth's gradient over the contacts: that of the linear function that fits their depths best. On a plane,
/// whatever part of it is touched, it is the plane's normal, of length 1. On several faces, it lies between their
/// normals.
inline Float3 depth_gradient(PrincipalAxes a, Float3 lean) {
  Float3 gradient = scaled(a.w1, slope_along(a.w1, a.l1, lean));
  gradient = moved(gradient, a.w2, slope_along(a.w2, a.l2, lean));
  return moved(gradient, a.w3, slope_along(a.w3, a.l3, lean));
}

/// How clearly the contacts alone show where a cross-section faces: 1 if they have a thinnest direction, 0 if two
/// eigenvalues are close.
inline float clearness_of(PrincipalAxes a) {
  float thickness = a.l2 > 0.0F ? a.l3 / a.l2 : 0.0F;
  float clearness = (unclear_above - thickness) / (unclear_above - clear_below);
  return clearness < 0.0F ? 0.0F : (clearness > 1.0F ? 1.0F : clearness);
}

/// The direction in which a cross-section faces that faced `before`: the principal w3 if it is clear, else the depth's
/// gradient. If depth hardly changes with place, the direction stays as before.
inline Float3 facing_of(PrincipalAxes principal, Float3 lean, Float3 before) {
  const float clear = clearness_of(principal);
  const Float3 w3 = nearer(principal.w3, before);
  if (clear >= 1.0F) return w3;
  const Float3 gradient = nearer(depth_gradient(principal, lean), before);
  float length = std::sqrt(dot3(gradient, gradient));
  float most = length / steep;
  const float trust = most < 1.0F ? most : 1.0F;
  float rest = 1.0F - trust;
  float along = length > 0.0F ? trust / length : 0.0F;
  const Float3 by_depth = moved(scaled(before, rest), gradient, along);
  float unclear = 1.0F - clear;
  const Float3 facing = moved(scaled(w3, clear), by_depth, unclear);
  return dot3(facing, facing) > 1.0e-6F ? unit(facing) : before;
}

/// In a cross-section's plane: the variances along its principal directions, and the first direction in coordinates of
/// two axes, with the sign that makes cosine >= 0.
struct Principal2 {
  float l1, l2;
  float cosine, sine;
};

inline Principal2 principal_in_plane(Sym3 m, Float3 w1, Float3 w2) {
  const Float3 m1 = times(m, w1);
  const Float3 m2 = times(m, w2);
  const float xx = dot3(w1, m1);
  const float xy = dot3(w1, m2);
  const float yy = dot3(w2, m2);
  float middle = 0.5F * (xx + yy);
  float apart = 0.5F * (xx - yy);
  float radius = std::sqrt(apart * apart + xy * xy);
  float l1 = middle + radius;
  float l2 = middle - radius;
  float least = 1.0e-6F * l1;  // as in is_point_like
  Principal2 r;
  r.l1 = l1;
  r.l2 = l2 > least ? l2 : least;
  r.cosine = 1.0F;
  r.sine = 0.0F;
  if (!(radius > 0.0F)) return r;
  // Cosine and sine of twice the angle.
  float cosine2 = apart / radius;
  float sine2 = xy / radius;
  if (cosine2 >= 0.0F) {
    float cosine = std::sqrt(0.5F * (1.0F + cosine2));
    float sine = 0.5F * sine2 / cosine;
    r.cosine = cosine;
    r.sine = sine;
  } else {
    float sine = std::sqrt(0.5F * (1.0F - cosine2));
    float cosine = 0.5F * std::abs(sine2) / sine;
    r.cosine = cosine;
    r.sine = sine2 < 0.0F ? -sine : sine;
  }
  return r;
}

/// The axes of the plane across w3; w1 is `carried` turned by (cosine, sine).
inline Steady axes_across(Sym3 covariance, Principal2 plane, Float3 w3, Float3 carried, Float3 across, float cosine,
                          float sine) {
  Steady r;
  r.axes.w3 = w3;
  const Float3 w1 = moved(scaled(carried, cosine), across, sine);
  r.axes.w1 = unit(moved(w1, w3, -dot3(w1, w3)));
  r.axes.w2 = cross3(w3, r.axes.w1);
  r.axes.l1 = plane.l1;
  r.axes.l2 = plane.l2;
  const float l3 = dot3(w3, times(covariance, w3));
  r.axes.l3 = l3 > 0.0F ? l3 : 0.0F;
  const Float3 first = moved(scaled(carried, plane.cosine), across, plane.sine);
  const float c1 = dot3(first, r.axes.w1);
  const float s1 = dot3(first, r.axes.w2);
  float norm = 1.0F / std::sqrt(c1 * c1 + s1 * s1);
  r.cosine = c1 * norm;
  r.sine = s1 * norm;
  return r;
}

/// For a finger without an earlier frame: the principal axes, unless depth shows better where they face. Signs as
/// theirs.
inline Steady first_axes(PrincipalAxes principal, Float3 lean) {
  Steady r;
  r.axes = principal;
  r.cosine = 1.0F;
  r.sine = 0.0F;
  if (clearness_of(principal) >= 1.0F) return r;
  const Float3 w3 = upwards(facing_of(principal, lean, principal.w3));
  Float3 carried = moved(principal.w1, w3, -dot3(principal.w1, w3));
  if (dot3(carried, carried) < 1.0e-4F) carried = moved(principal.w2, w3, -dot3(principal.w2, w3));
  carried = unit(carried);
  const Float3 across = cross3(w3, carried);
  const Sym3 covariance = covariance_of(principal);
  const Principal2 plane = principal_in_plane(covariance, carried, across);
  const Float3 w1 = moved(scaled(carried, plane.cosine), across, plane.sine);
  const float sign = largest_component(w1) < 0.0F ? -1.0F : 1.0F;
  return axes_across(covariance, plane, w3, carried, across, sign * plane.cosine, sign * plane.sine);
}

/// `old` turned towards a direction by a share of the angle, at most by most_turn_per_s.
inline Float3 turned_towards(Float3 old, Float3 direction, float share, float frame_s) {
  const Float3 way = minus(direction, old);
  float chord = std::sqrt(dot3(way, way));
  float wanted = share * chord;
  float most = most_turn_per_s * frame_s;
  if (!(wanted > most)) return unit(moved(old, way, share));
  float factor = most / chord;
  return unit(moved(old, way, factor));
}

/// w3 turns towards the direction in which the cross-section faces, at once if that is clear. The old w1 is carried
/// over by the smallest rotation that takes the old w3 to the new one. It is then turned in the plane towards the
/// nearer of the principal directions, the more elongated the cross-section, the farther.
inline Steady steady_axes(PrincipalAxes principal, Float3 lean, Float3 old1, Float3 old3, float frame_s) {
  float slowness = facing_s * (1.0F - clearness_of(principal));
  float settled = frame_s / (frame_s + slowness);
  const float settling = slowness > 0.0F ? settled : 1.0F;
  const Float3 w3 = turned_towards(old3, facing_of(principal, lean, old3), settling, frame_s);
  const Float3 both = moved(w3, old3, 1.0F);
  float factor = -(dot3(w3, old1) / (1.0F + dot3(w3, old3)));
  Float3 carried = moved(old1, both, factor);
  carried = unit(moved(carried, w3, -dot3(carried, w3)));
  const Float3 across = cross3(w3, carried);

  const Sym3 covariance = covariance_of(principal);
  const Principal2 plane = principal_in_plane(covariance, carried, across);
  float sum = plane.l1 + plane.l2;
  float elongation = sum > 0.0F ? (plane.l1 - plane.l2) / sum : 0.0F;
  float beyond = frame_s * (elongation - round_below);
  float missing = settling_s * (long_above - elongation);
  float quick = beyond / (beyond + missing);
  const float share = elongation <= round_below || !(beyond > 0.0F) ? 0.0F : (elongation >= long_above ? 1.0F : quick);
  float ahead = 1.0F - share + share * plane.cosine;
  float aside = share * plane.sine;
  float chord = std::sqrt(ahead * ahead + aside * aside);
  float sine = aside / chord;
  float cosine = ahead / chord;
  float allowed = most_turn_per_s * frame_s;
  const float most = allowed < 0.7F ? allowed : 0.7F;
  float rest = std::sqrt(1.0F - most * most);
  if (std::abs(sine) > most) {
    sine = sine < 0.0F ? -most : most;
    cosine = rest;
  }
  return axes_across(covariance, plane, w3, carried, across, cosine, sine);
}

}  // namespace palpa::touch
