// The arithmetic of fingers: what they share with the kernels (shaders/shared/exact_math.h), and more of the same.
// Decisions are made in single precision, and no compiler fuses a product with a sum: the engine is built with
// -ffp-contract=off.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "shaders/shared/exact_math.h"

namespace palpa::touch {

using shader::Float3;

struct Float2 {
  float x, y;
};

inline Float3 float3(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}
inline Float3 float3(const shader::vec4& v) {
  return {v.x, v.y, v.z};
}
inline glm::vec3 to_vec(const Float3& v) {
  return {v.x, v.y, v.z};
}

/// A time of `us` that has gone on for `elapsed_us`. It ends at the longest time, 71 minutes.
inline std::uint32_t us_after(std::uint32_t us, std::uint32_t elapsed_us) {
  return us > 0xffffffffU - elapsed_us ? 0xffffffffU : us + elapsed_us;
}

inline Float3 unit(Float3 a) {
  return scaled(a, 1.0F / std::sqrt(dot3(a, a)));
}

inline Float3 plus(Float3 a, Float3 b) {
  Float3 r;
  r.x = a.x + b.x;
  r.y = a.y + b.y;
  r.z = a.z + b.z;
  return r;
}

inline Float3 lowest(const Float3& a, const Float3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

inline Float3 highest(const Float3& a, const Float3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

/// The gap between two intervals; 0 if they overlap.
inline float gap_between(float low_a, float high_a, float low_b, float high_b) {
  return std::max({low_b - high_a, low_a - high_b, 0.0F});
}

/// The square of the gap between two boxes.
inline float square_between(const Float3& low_a, const Float3& high_a, const Float3& low_b, const Float3& high_b) {
  const Float3 gap{gap_between(low_a.x, high_a.x, low_b.x, high_b.x), gap_between(low_a.y, high_a.y, low_b.y, high_b.y),
                   gap_between(low_a.z, high_a.z, low_b.z, high_b.z)};
  return dot3(gap, gap);
}

inline float square_apart(Float3 a, Float3 b) {
  const Float3 d = minus(a, b);
  return dot3(d, d);
}

/// The cosine between the direction `normal` at `from` and the way to `to`.
inline float cosine_of_way(Float3 from, Float3 normal, Float3 to) {
  const Float3 way = minus(to, from);
  const float square = dot3(way, way);
  float cosine = square > 0.0F ? dot3(way, normal) / std::sqrt(square) : 0.0F;
  return cosine;
}

}  // namespace palpa::touch
