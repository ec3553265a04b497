// The arithmetic of fingers. Decisions are made in single precision, and no compiler fuses a product with a sum: the
// engine is built with -ffp-contract=off.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <limits>

namespace palpa::touch {

/// A time of `us` that has gone on for `elapsed_us`. It ends at the longest time, 71 minutes.
inline std::uint32_t us_after(std::uint32_t us, std::uint32_t elapsed_us) {
  return us + std::min(elapsed_us, std::numeric_limits<std::uint32_t>::max() - us);
}

/// The square of the gap between two boxes; 0 if they overlap.
inline float square_between(const glm::vec3& low_a, const glm::vec3& high_a, const glm::vec3& low_b,
                            const glm::vec3& high_b) {
  const glm::vec3 gap = glm::max(glm::max(low_b - high_a, low_a - high_b), glm::vec3(0));
  return glm::dot(gap, gap);
}

inline float square_apart(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 d = a - b;
  return glm::dot(d, d);
}

/// The cosine between the direction `normal` at `from` and the way to `to`.
inline float cosine_of_way(const glm::vec3& from, const glm::vec3& normal, const glm::vec3& to) {
  const glm::vec3 way = to - from;
  const float square = glm::dot(way, way);
  return square > 0 ? glm::dot(way, normal) / std::sqrt(square) : 0;
}

}  // namespace palpa::touch
