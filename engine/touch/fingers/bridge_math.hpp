// The arithmetic of bridging. The rules are in docs/touch.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "touch/fingers/exact.hpp"

// A constant of the rules, or what is compared with it. tests/tools/split_sensitivity.cpp scales it by its name.
#ifndef PALPA_TUNED
#define PALPA_TUNED(name, value) value
#endif

namespace palpa::touch {

/// Number of values of the hash of contact numbers. For each value, one contact of a finger is a sample for all others.
inline constexpr std::uint32_t bridge_samples = 64U;
inline constexpr std::uint32_t bridge_sample_shift = 26U;
/// An invertible hash: contact = hash * inverse, modulo 2^32.
inline constexpr std::uint32_t bridge_hash = 0x9e3779b1U;
inline constexpr std::uint32_t bridge_unhash = 0x0e8b2f51U;

/// A camera with the data to use its picture in both directions: pixel to point and point to pixel.
struct BridgeCamera {
  shader::vec4 pose_x;  // rows of T_world_camera
  shader::vec4 pose_y;
  shader::vec4 pose_z;
  shader::vec4 view_x;  // rows of T_camera_world
  shader::vec4 view_y;
  shader::vec4 view_z;
  shader::vec4 lens;        // fx, fy, cx, cy
  shader::vec4 distortion;  // k1, k2, p1, p2
  float k3;
  float reach;                // the square of the longest ray of the picture: beyond it the lens model may fold back
  float depth_unit;           // metres
  std::uint32_t first_depth;  // raw depths below are no data
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t pitch;        // pixels from row to row of the padded arrangement
  std::uint32_t first_pixel;  // of the padded arrangement
  std::uint32_t first_index;  // of the camera's skin points
};

/// A cluster of contacts, which may be one patch of several.
struct BridgePatch {
  shader::vec4 low;  // box and mean of its samples
  shader::vec4 high;
  shader::vec4 mean;
  std::uint32_t samples;
};

/// The relation between two patches.
inline constexpr std::uint32_t bridge_unknown = 0U;  // nothing shows that they are one finger
inline constexpr std::uint32_t bridge_one = 1U;      // patches of one finger
inline constexpr std::uint32_t bridge_two = 2U;      // of two fingers, whatever a third patch shows
struct BridgePair {
  std::uint32_t kind;
  float facing;  // the smaller, the more certain: see facing_verdict
};

/// Pixels to either side that give the skin's normal. A larger step in depth than this is the edge of another object.
inline constexpr std::uint32_t bridge_normal_pixels = 2U;
#define PALPA_BRIDGE_STEP PALPA_TUNED(rim, 4e-3F)
/// A place is empty if a camera has seen something farther away than the place by at least this much.
#define PALPA_BRIDGE_CLEAR PALPA_TUNED(clear, 4e-3F)
/// No pixel's ray leans this far. Tables hold a larger value if there is no ray.
#define PALPA_BRIDGE_NO_RAY 1e17F
/// Contacts that are farther apart than the nearest ones by this much no longer face each other.
#define PALPA_BRIDGE_FACING PALPA_TUNED(nearest, 2e-3F)

inline Float3 rotated(shader::vec4 x, shader::vec4 y, shader::vec4 z, Float3 v) {
  Float3 r;
  r.x = x.x * v.x + x.y * v.y + x.z * v.z;
  r.y = y.x * v.x + y.y * v.y + y.z * v.z;
  r.z = z.x * v.x + z.y * v.y + z.z * v.z;
  return r;
}

inline Float3 seen_from(BridgeCamera camera, Float3 world) {
  const Float3 r = rotated(camera.view_x, camera.view_y, camera.view_z, world);
  Float3 p;
  p.x = r.x + camera.view_x.w;
  p.y = r.y + camera.view_y.w;
  p.z = r.z + camera.view_z.w;
  return p;
}

/// The pixel and depth at which a point in front of a camera appears. Outside the picture: depth 0.
struct Appearance {
  std::uint32_t u, v;
  float depth;
};

inline Appearance appearance(BridgeCamera camera, Float3 world) {
  const Float3 p = seen_from(camera, world);
  Appearance a;
  a.u = 0U;
  a.v = 0U;
  a.depth = 0.0F;
  if (!(p.z > 1e-3F)) return a;
  float x = p.x / p.z;
  float y = p.y / p.z;
  float r2 = x * x + y * y;
  if (!(r2 <= camera.reach)) return a;
  float radial = 1.0F + r2 * (camera.distortion.x + r2 * (camera.distortion.y + r2 * camera.k3));
  float xd = x * radial + 2.0F * camera.distortion.z * x * y + camera.distortion.w * (r2 + 2.0F * x * x);
  float yd = y * radial + camera.distortion.z * (r2 + 2.0F * y * y) + 2.0F * camera.distortion.w * x * y;
  float u = std::floor(camera.lens.x * xd + camera.lens.z + 0.5F);
  float v = std::floor(camera.lens.y * yd + camera.lens.w + 0.5F);
  if (!(u >= 0.0F && v >= 0.0F && u < float(camera.width) && v < float(camera.height))) return a;
  a.u = std::uint32_t(u);
  a.v = std::uint32_t(v);
  a.depth = p.z;
  return a;
}

/// Whether a camera whose raw depth at a place's pixel is `raw` looked through that place.
inline bool sees_through(BridgeCamera camera, std::uint32_t raw, float depth) {
  float seen = float(raw) * camera.depth_unit;
  return raw >= camera.first_depth && seen > depth + PALPA_BRIDGE_CLEAR;
}

/// A pixel's point in camera coordinates. The depth is 0 if there is no data or no ray, or if the camera ignores the
/// pixel.
inline Float3 pixel_point(BridgeCamera camera, std::uint32_t raw, Float2 ray) {
  Float3 p;
  p.z = raw >= camera.first_depth && ray.x < PALPA_BRIDGE_NO_RAY ? float(raw) * camera.depth_unit : 0.0F;
  p.x = ray.x * p.z;
  p.y = ray.y * p.z;
  return p;
}

inline bool same_surface(Float3 a, Float3 b) {
  float step = a.z - b.z;
  return b.z > 0.0F && std::abs(step) <= PALPA_BRIDGE_STEP;
}

/// From one neighbour to the other if both are on the surface, else between one of them and the pixel; 0 if neither is.
inline Float3 tangent(Float3 at, Float3 before, Float3 after) {
  const bool has_before = same_surface(at, before);
  const bool has_after = same_surface(at, after);
  Float3 from = at;
  Float3 to = at;
  if (has_before) from = before;
  if (has_after) to = after;
  return minus(to, from);
}

/// The skin's outward normal in the world, from a pixel's point and its neighbours' (camera coordinates). It is zero if
/// they do not give one: such pixels lie on rims or float beside them, and are no samples.
inline Float3 skin_normal(BridgeCamera camera, Float3 at, Float3 left, Float3 right, Float3 above, Float3 below) {
  Float3 normal = cross3(tangent(at, left, right), tangent(at, above, below));
  if (!(dot3(normal, normal) > 1e-16F)) return minus(at, at);
  if (dot3(normal, at) > 0.0F) normal = scaled(normal, -1.0F);
  return unit(rotated(camera.pose_x, camera.pose_y, camera.pose_z, normal));
}

inline float square_apart(Float3 a, Float3 b) {
  const Float3 d = minus(a, b);
  return dot3(d, d);
}

/// The cosine between the skin's outward normal at `from` and the way to `to`. It is below 0 if that way enters the
/// skin, which is the case between any two places of one convex fingertip.
inline float cosine_of_way(Float3 from, Float3 normal, Float3 to) {
  const Float3 way = minus(to, from);
  const float square = dot3(way, way);
  float cosine = square > 0.0F ? dot3(way, normal) / std::sqrt(square) : 0.0F;
  return cosine;
}

inline Float3 between(Float3 a, Float3 b, float share) {
  Float3 p;
  p.x = a.x + share * (b.x - a.x);
  p.y = a.y + share * (b.y - a.y);
  p.z = a.z + share * (b.z - a.z);
  return p;
}

inline Float3 plus(Float3 a, Float3 b) {
  Float3 r;
  r.x = a.x + b.x;
  r.y = a.y + b.y;
  r.z = a.z + b.z;
  return r;
}

// ---- a pair of patches ----

/// The gap between two intervals.
inline float gap_between(float low_a, float high_a, float low_b, float high_b) {
  float left = low_b - high_a;
  float right = low_a - high_b;
  float gap = left > right ? left : right;
  return gap > 0.0F ? gap : 0.0F;
}

/// Whether the patches' boxes are near enough that they can be one finger.
inline bool near_enough(BridgePatch a, BridgePatch b, float finger_width) {
  if (a.samples == 0U || b.samples == 0U) return false;
  Float3 gap;
  gap.x = gap_between(a.low.x, a.high.x, b.low.x, b.high.x);
  gap.y = gap_between(a.low.y, a.high.y, b.low.y, b.high.y);
  gap.z = gap_between(a.low.z, a.high.z, b.low.z, b.high.z);
  return dot3(gap, gap) <= product(finger_width, finger_width);
}

/// Chords through the space between two patches: from each sample of one patch to some sample of the other, checked in
/// steps of an eighth. Their ends are left out, because pictures of rims are the least reliable there.
inline constexpr std::uint32_t bridge_first_step = 2U;
inline constexpr std::uint32_t bridge_last_step = 6U;
inline std::uint32_t chord_end(std::uint32_t sample_a, std::uint32_t samples_b) {
  return (sample_a * 37U + 11U) % samples_b;
}
inline float chord_share(std::uint32_t step) {
  return float(step) * 0.125F;
}

/// The evidence of the ways between contacts that face each other: the cosines at their ends, summed.
struct Evidence {
  float nearest;
  float leaving_a, leaving_b;
  std::uint32_t facing;
};

inline Evidence no_evidence() {
  Evidence e;
  e.nearest = 3.0e38F;
  e.leaving_a = 0.0F;
  e.leaving_b = 0.0F;
  e.facing = 0U;
  return e;
}

inline Evidence with_length(Evidence e, float apart) {
  if (apart < e.nearest) e.nearest = apart;
  return e;
}

/// Call it only once `nearest` is known.
inline Evidence with_way(Evidence e, float apart, float leaving_a, float leaving_b) {
  if (apart > e.nearest + PALPA_BRIDGE_FACING) return e;
  float a = e.leaving_a + leaving_a;
  float b = e.leaving_b + leaving_b;
  e.leaving_a = a;
  e.leaving_b = b;
  e.facing += 1U;
  return e;
}

/// The three questions, the cheapest first. A pair that fails one is two fingers and needs no further check.

/// `low` and `high`: the samples' smallest and largest product with the line from mean to mean, whose square is given.
inline bool too_wide(float low, float high, float line_square, float finger_width) {
  float width = high - low;
  return width > product(finger_width, std::sqrt(line_square));
}

#define PALPA_BRIDGE_AWAY PALPA_TUNED(away, -0.1F)
#define PALPA_BRIDGE_TOWARDS PALPA_TUNED(towards, 0.3F)
/// Patches that were one finger in the frame before stay one up to these limits, and in a finger that is wider by the
/// first factor.
#define PALPA_BRIDGE_STILL_ONE 1.2F
#define PALPA_BRIDGE_STILL_AWAY 0.3F
#define PALPA_BRIDGE_STILL_TOWARDS 0.5F
/// In place of the sum of cosines, for patches that are one only because they were one: less certain than any other.
#define PALPA_BRIDGE_HELD 3.0F

inline BridgePair facing_verdict(Evidence e, bool were_one) {
  BridgePair pair;
  pair.kind = bridge_two;
  pair.facing = 0.0F;
  float a = e.leaving_a / float(e.facing);
  float b = e.leaving_b / float(e.facing);
  const float worse = a > b ? a : b;
  if (worse > (were_one ? PALPA_BRIDGE_STILL_TOWARDS : PALPA_BRIDGE_TOWARDS)) return pair;
  float sum = a + b;
  pair.kind = worse < (were_one ? PALPA_BRIDGE_STILL_AWAY : PALPA_BRIDGE_AWAY) ? bridge_one : bridge_unknown;
  pair.facing = sum;
  return pair;
}

/// Two patches are two fingers if more of the places between them are seen empty than this, in 64ths.
inline constexpr std::uint32_t bridge_most_empty = 6U;
inline constexpr std::uint32_t bridge_still_empty = 24U;  // for patches that were one
inline bool too_empty(std::uint32_t empty, std::uint32_t looked, bool were_one) {
  return empty * 64U > looked * (were_one ? bridge_still_empty : PALPA_TUNED(empty, bridge_most_empty));
}

}  // namespace palpa::touch
