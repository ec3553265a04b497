// Which triangles can be the nearest somewhere in a cell: those that no rival beats at all corners of the cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>

#include "base/math.hpp"

namespace palpa::geometry {

using Corners = std::array<glm::vec3, 8>;

/// A surface point that every triangle of a cell is compared with.
struct Rival {
  Vec3 point;
  std::uint32_t triangle;
};
inline constexpr std::size_t most_rivals = 9;

/// The rivals of one cell, and their squared distances from its corners.
struct Contest {
  std::array<std::array<float, 8>, most_rivals> to_corner;
  std::array<float, most_rivals> margin;
  std::array<std::uint32_t, most_rivals> triangle;
  std::size_t count = 0;

  /// `slack` is a squared distance by which a nearer rival may be farther away.
  void add(const Rival& rival, const Corners& corners, double epsilon, double slack) {
    for (std::size_t i = 0; i < count; ++i) {
      if (triangle[i] == rival.triangle && to_corner[i] == distances(rival.point, corners)) return;
    }
    to_corner[count] = distances(rival.point, corners);
    const double farthest = std::sqrt(*std::max_element(to_corner[count].begin(), to_corner[count].end()));
    margin[count] = static_cast<float>(24 * farthest * epsilon + 8 * epsilon * epsilon - slack);
    triangle[count] = rival.triangle;
    ++count;
  }

  /// Whether an object at these squared distances from the corners is nearest nowhere in the cell.
  template <typename Distance2>
  bool beats(const Distance2& distance2) const {
    for (std::size_t r = 0; r < count; ++r) {
      float least = distance2[0] - to_corner[r][0];
      for (std::size_t c = 1; c < 8; ++c) {
        const float ahead = distance2[c] - to_corner[r][c];
        least = ahead < least ? ahead : least;
      }
      if (least > margin[r]) return true;
    }
    return false;
  }

 private:
  static std::array<float, 8> distances(const Vec3& point, const Corners& corners) {
    std::array<float, 8> d;
    for (std::size_t c = 0; c < 8; ++c) {
      const Vec3 apart = Vec3(corners[c]) - point;
      d[c] = static_cast<float>(glm::dot(apart, apart));
    }
    return d;
  }
};

}  // namespace palpa::geometry
