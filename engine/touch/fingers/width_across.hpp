// How wide skin is across a line.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "base/inplace_vector.hpp"
#include "touch/fingers/exact.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::touch {

/// The largest distance between two places, without the part along the line. At most 2 * most_samples places.
inline float width_across(std::span<const glm::vec3> places, const glm::vec3& line) {
  const float square = glm::dot(line, line);
  InplaceVector<glm::vec3, std::size_t{2} * most_samples> across;
  for (const glm::vec3& place : places) {
    const glm::vec3 from = place - places.front();
    across.push_back(square > 0 ? from - line * (glm::dot(from, line) / square) : from);
  }
  float widest = 0;
  for (std::size_t i = 0; i < across.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k)
      widest = std::max(widest, square_apart(across[i], across[k]));
  }
  return std::sqrt(widest);
}

}  // namespace palpa::touch
