// Which triangles can be the nearest somewhere in a cell: those that no rival beats at all corners of the cell.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>

#include "base/lanes.hpp"
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
  std::array<std::array<float, 8>, most_rivals + 1> to_corner;  // one spare, for a rival that proves to be a duplicate
  std::array<float, most_rivals> margin;
  std::array<std::uint32_t, most_rivals> triangle;
  std::size_t count = 0;

  /// The rival also beats objects that are nearer, if the squared distances differ by less than `slack`.
  void add(const Rival& rival, const Corners& corners, double epsilon, double slack) {
    std::array<float, 8>& own = to_corner[count];
    own = distances(rival.point, corners);
    for (std::size_t i = 0; i < count; ++i) {
      if (triangle[i] == rival.triangle && to_corner[i] == own) return;
    }
    const double farthest = std::sqrt(*std::max_element(own.begin(), own.end()));
    margin[count] = static_cast<float>(24 * farthest * epsilon + 8 * epsilon * epsilon - slack);
    triangle[count] = rival.triangle;
    ++count;
  }

  /// Whether an object at these squared distances from the corners is nearest nowhere in the cell: whether one rival is
  /// nearer to all corners by more than its margin.
  bool beats(const std::array<float, 8>& distance2) const {
    return beats<Lanes4>({load_lanes<Lanes4>(distance2.data()), load_lanes<Lanes4>(distance2.data() + 4)});
  }

  /// The same for distances in vectors. Large models spend much of their time here.
  template <class L>
  [[gnu::always_inline]] bool beats(const std::array<typename L::Float, 8 / L::width>& distance2) const {
    for (std::size_t r = 0; r < count; ++r) {
      typename L::Bits ahead = distance2[0] - load_lanes<L>(to_corner[r].data()) > margin[r];
      for (std::size_t part = 1; part < distance2.size(); ++part)
        ahead &= distance2[part] - load_lanes<L>(to_corner[r].data() + part * L::width) > margin[r];
      if (all_set<L>(ahead)) return true;
    }
    return false;
  }

 private:
  static std::array<float, 8> distances(const Vec3& point, const Corners& corners) {
    std::array<float, 8> x, y, z, d;
    for (std::size_t c = 0; c < 8; ++c) {
      x[c] = corners[c].x;
      y[c] = corners[c].y;
      z[c] = corners[c].z;
    }
    for (std::size_t c = 0; c < 8; ++c) {
      const double ax = double{x[c]} - point.x, ay = double{y[c]} - point.y, az = double{z[c]} - point.z;
      d[c] = static_cast<float>(ax * ax + ay * ay + az * az);
    }
    return d;
  }
};

}  // namespace palpa::geometry
