// The arithmetic of bridging, the same in shaders and twin: see exact_math.h.
#ifndef PALPA_SHADERS_BRIDGE_MATH_H
#define PALPA_SHADERS_BRIDGE_MATH_H
#include "shaders/shared/exact_math.h"
#include "shaders/touch/bridge/bridge.h"
PALPA_SHADER_BEGIN

// Pixels to either side that give the skin's normal. A larger step in depth than this is the edge of another object.
PALPA_CONST bridge_normal_pixels = 2u;
#define PALPA_BRIDGE_STEP PALPA_TUNED(rim, 4e-3f)
// A place is empty if a camera has seen something farther away than the place by at least this much.
#define PALPA_BRIDGE_CLEAR PALPA_TUNED(clear, 4e-3f)
// No pixel's ray leans this far. Tables hold a larger value if there is no ray.
#define PALPA_BRIDGE_NO_RAY 1e17f
// Contacts that are farther apart than the nearest ones by this much no longer face each other.
#define PALPA_BRIDGE_FACING PALPA_TUNED(nearest, 2e-3f)

PALPA_FN Float3 rotated(vec4 x, vec4 y, vec4 z, Float3 v) {
  PALPA_EXACT Float3 r;
  r.x = x.x * v.x + x.y * v.y + x.z * v.z;
  r.y = y.x * v.x + y.y * v.y + y.z * v.z;
  r.z = z.x * v.x + z.y * v.y + z.z * v.z;
  return r;
}

PALPA_FN Float3 seen_from(BridgeCamera camera, Float3 world) {
  const Float3 r = rotated(camera.view_x, camera.view_y, camera.view_z, world);
  PALPA_EXACT Float3 p;
  p.x = r.x + camera.view_x.w;
  p.y = r.y + camera.view_y.w;
  p.z = r.z + camera.view_z.w;
  return p;
}

// The pixel and depth at which a point in front of a camera appears. Outside the picture: depth 0.
struct Appearance {
  uint u, v;
  float depth;
};

PALPA_FN Appearance appearance(BridgeCamera camera, Float3 world) {
  const Float3 p = seen_from(camera, world);
  Appearance a;
  a.u = 0u;
  a.v = 0u;
  a.depth = 0.0f;
  if (!(p.z > 1e-3f)) return a;
  PALPA_EXACT float x = p.x / p.z;
  PALPA_EXACT float y = p.y / p.z;
  PALPA_EXACT float r2 = x * x + y * y;
  if (!(r2 <= camera.reach)) return a;
  PALPA_EXACT float radial = 1.0f + r2 * (camera.distortion.x + r2 * (camera.distortion.y + r2 * camera.k3));
  PALPA_EXACT float xd = x * radial + 2.0f * camera.distortion.z * x * y + camera.distortion.w * (r2 + 2.0f * x * x);
  PALPA_EXACT float yd = y * radial + camera.distortion.z * (r2 + 2.0f * y * y) + 2.0f * camera.distortion.w * x * y;
  PALPA_EXACT float u = floor(camera.lens.x * xd + camera.lens.z + 0.5f);
  PALPA_EXACT float v = floor(camera.lens.y * yd + camera.lens.w + 0.5f);
  if (!(u >= 0.0f && v >= 0.0f && u < float(camera.width) && v < float(camera.height))) return a;
  a.u = uint(u);
  a.v = uint(v);
  a.depth = p.z;
  return a;
}

// Whether a camera whose raw depth at a place's pixel is `raw` looked through that place.
PALPA_FN bool sees_through(BridgeCamera camera, uint raw, float depth) {
  PALPA_EXACT float seen = float(raw) * camera.depth_unit;
  return raw >= camera.first_depth && seen > depth + PALPA_BRIDGE_CLEAR;
}

// A pixel's point in camera coordinates. The depth is 0 if there is no data or no ray, or if the camera ignores the
// pixel.
PALPA_FN Float3 pixel_point(BridgeCamera camera, uint raw, Float2 ray) {
  PALPA_EXACT Float3 p;
  p.z = raw >= camera.first_depth && ray.x < PALPA_BRIDGE_NO_RAY ? float(raw) * camera.depth_unit : 0.0f;
  p.x = ray.x * p.z;
  p.y = ray.y * p.z;
  return p;
}

PALPA_FN bool same_surface(Float3 a, Float3 b) {
  PALPA_EXACT float step = a.z - b.z;
  return b.z > 0.0f && abs(step) <= PALPA_BRIDGE_STEP;
}

// From one neighbour to the other if both are on the surface, else between one of them and the pixel; 0 if neither is.
PALPA_FN Float3 tangent(Float3 at, Float3 before, Float3 after) {
  const bool has_before = same_surface(at, before);
  const bool has_after = same_surface(at, after);
  Float3 from = at;
  Float3 to = at;
  if (has_before) from = before;
  if (has_after) to = after;
  return minus(to, from);
}

// The skin's outward normal in the world, from a pixel's point and its neighbours' (camera coordinates). It is zero if
// they do not give one: such pixels lie on rims or float beside them, and are no samples.
PALPA_FN Float3 skin_normal(BridgeCamera camera, Float3 at, Float3 left, Float3 right, Float3 above, Float3 below) {
  Float3 normal = cross3(tangent(at, left, right), tangent(at, above, below));
  if (!(dot3(normal, normal) > 1e-16f)) return minus(at, at);
  if (dot3(normal, at) > 0.0f) normal = scaled(normal, -1.0f);
  return unit(rotated(camera.pose_x, camera.pose_y, camera.pose_z, normal));
}

PALPA_FN float square_apart(Float3 a, Float3 b) {
  const Float3 d = minus(a, b);
  return dot3(d, d);
}

// The cosine between the skin's outward normal at `from` and the way to `to`. It is below 0 if that way enters the
// skin, which is the case between any two places of one convex fingertip.
PALPA_FN float leaving(Float3 from, Float3 normal, Float3 to) {
  const Float3 way = minus(to, from);
  const float square = dot3(way, way);
  PALPA_EXACT float cosine = square > 0.0f ? dot3(way, normal) / sqrt(square) : 0.0f;
  return cosine;
}

PALPA_FN Float3 between(Float3 a, Float3 b, float share) {
  PALPA_EXACT Float3 p;
  p.x = a.x + share * (b.x - a.x);
  p.y = a.y + share * (b.y - a.y);
  p.z = a.z + share * (b.z - a.z);
  return p;
}

PALPA_FN Float3 plus(Float3 a, Float3 b) {
  PALPA_EXACT Float3 r;
  r.x = a.x + b.x;
  r.y = a.y + b.y;
  r.z = a.z + b.z;
  return r;
}

// ---- a pair of patches ----

// The gap between two intervals.
PALPA_FN float gap_between(float low_a, float high_a, float low_b, float high_b) {
  PALPA_EXACT float left = low_b - high_a;
  PALPA_EXACT float right = low_a - high_b;
  float gap = left > right ? left : right;
  return gap > 0.0f ? gap : 0.0f;
}

// Whether the patches' boxes are near enough that they can be one finger.
PALPA_FN bool near_enough(BridgePatch a, BridgePatch b, float finger_width) {
  if (a.samples == 0u || b.samples == 0u) return false;
  Float3 gap;
  gap.x = gap_between(a.low.x, a.high.x, b.low.x, b.high.x);
  gap.y = gap_between(a.low.y, a.high.y, b.low.y, b.high.y);
  gap.z = gap_between(a.low.z, a.high.z, b.low.z, b.high.z);
  return dot3(gap, gap) <= product(finger_width, finger_width);
}

// Chords through the space between two patches: from each sample of one patch to some sample of the other, checked in
// steps of an eighth. Their ends are left out, because pictures of rims are the least reliable there.
PALPA_CONST bridge_first_step = 2u;
PALPA_CONST bridge_last_step = 6u;
PALPA_FN uint chord_end(uint sample_a, uint samples_b) {
  return (sample_a * 37u + 11u) % samples_b;
}
PALPA_FN float chord_share(uint step) {
  return float(step) * 0.125f;
}

// The evidence of the ways between contacts that face each other: the cosines at their ends, summed.
struct Evidence {
  float nearest;
  float leaving_a, leaving_b;
  uint facing;
};

PALPA_FN Evidence no_evidence() {
  Evidence e;
  e.nearest = 3.0e38f;
  e.leaving_a = 0.0f;
  e.leaving_b = 0.0f;
  e.facing = 0u;
  return e;
}

PALPA_FN Evidence with_length(Evidence e, float apart) {
  if (apart < e.nearest) e.nearest = apart;
  return e;
}

// Call it only once `nearest` is known.
PALPA_FN Evidence with_way(Evidence e, float apart, float leaving_a, float leaving_b) {
  if (apart > e.nearest + PALPA_BRIDGE_FACING) return e;
  PALPA_EXACT float a = e.leaving_a + leaving_a;
  PALPA_EXACT float b = e.leaving_b + leaving_b;
  e.leaving_a = a;
  e.leaving_b = b;
  e.facing += 1u;
  return e;
}

// The three questions, the cheapest first. A pair that fails one is two fingers and needs no further check.

// `low` and `high`: the samples' smallest and largest product with the line from mean to mean, whose square is given.
PALPA_FN bool too_wide(float low, float high, float line_square, float finger_width) {
  PALPA_EXACT float width = high - low;
  return width > product(finger_width, sqrt(line_square));
}

#define PALPA_BRIDGE_AWAY PALPA_TUNED(away, -0.1f)
#define PALPA_BRIDGE_TOWARDS PALPA_TUNED(towards, 0.3f)
// Patches that were one finger in the frame before stay one up to these limits, and in a finger that is wider by the
// first factor.
#define PALPA_BRIDGE_STILL_ONE 1.2f
#define PALPA_BRIDGE_STILL_AWAY 0.3f
#define PALPA_BRIDGE_STILL_TOWARDS 0.5f
// In place of the sum of cosines, for patches that are one only because they were one: less certain than any other.
#define PALPA_BRIDGE_HELD 3.0f

PALPA_FN BridgePair facing_verdict(Evidence e, bool were_one) {
  BridgePair pair;
  pair.kind = bridge_two;
  pair.facing = 0.0f;
  PALPA_EXACT float a = e.leaving_a / float(e.facing);
  PALPA_EXACT float b = e.leaving_b / float(e.facing);
  const float worse = a > b ? a : b;
  if (worse > (were_one ? PALPA_BRIDGE_STILL_TOWARDS : PALPA_BRIDGE_TOWARDS)) return pair;
  PALPA_EXACT float sum = a + b;
  pair.kind = worse < (were_one ? PALPA_BRIDGE_STILL_AWAY : PALPA_BRIDGE_AWAY) ? bridge_one : bridge_unknown;
  pair.facing = sum;
  return pair;
}

// Two patches are two fingers if more of the places between them are seen empty than this, in 64ths.
PALPA_CONST bridge_most_empty = 6u;
PALPA_CONST bridge_still_empty = 24u;  // for patches that were one
PALPA_FN bool too_empty(uint empty, uint looked, bool were_one) {
  return empty * 64u > looked * (were_one ? bridge_still_empty : PALPA_TUNED(empty, bridge_most_empty));
}

PALPA_SHADER_END
#endif
