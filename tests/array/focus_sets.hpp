// The sets of foci for which the solvers' figures are stated, and how far transducers are from one.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::array {

inline double farthest_of(const Layout& layout, const Vec3& focus) {
  double farthest = 0;
  for (const Transducer& transducer : layout.transducers)
    farthest = std::max(farthest, glm::distance(transducer.position, focus));
  return farthest;
}

/// `count` random foci in a cube of 60 mm around `centre`, at least 8 mm apart.
inline std::vector<SlotFocus> focus_set(unsigned seed, std::size_t count = 10, const Vec3& centre = Vec3(0)) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-0.03, 0.03);
  std::vector<SlotFocus> foci;
  while (foci.size() < count) {
    const double x = place(random), y = place(random), z = place(random);
    const Vec3 position = centre + Vec3(x, y, z);
    bool apart = true;
    for (const SlotFocus& other : foci)
      apart = apart && glm::distance(other.position, position) >= 8e-3;
    if (apart) foci.push_back({position, 1});
  }
  return foci;
}

/// `count` foci evenly on a circle about `centre`, in the plane of the two unit vectors.
inline std::vector<SlotFocus> ring(std::size_t count, double radius, const Vec3& centre, const Vec3& u, const Vec3& v) {
  std::vector<SlotFocus> foci;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    foci.push_back({centre + radius * (std::cos(angle) * u + std::sin(angle) * v)});
  }
  return foci;
}

/// `count` random foci in a ball, with no least distance.
inline std::vector<SlotFocus> ball(unsigned seed, std::size_t count, double radius, const Vec3& centre) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<SlotFocus> foci;
  while (foci.size() < count) {
    const double x = place(random), y = place(random), z = place(random);
    if (const Vec3 way(x, y, z); glm::length(way) <= 1) foci.push_back({centre + radius * way});
  }
  return foci;
}

/// Sets of ten foci as near to each other as those of a fingertip: rings of 2 to 10 mm radius in any plane, and balls.
inline std::vector<std::vector<SlotFocus>> crowds(const Vec3& centre) {
  std::vector<std::vector<SlotFocus>> sets;
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const Vec3 slanted = glm::normalize(Vec3(1, 2, -0.5));
  const Vec3 across = glm::normalize(glm::cross(slanted, Vec3(0.3, 0.1, 1)));
  for (const double radius : {2e-3, 2.5e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3, 8e-3, 10e-3}) {
    for (const auto& [u, v] : {std::pair(x, y), {x, z}, {y, z}, {slanted, across}})
      sets.push_back(ring(10, radius, centre, u, v));
  }
  for (unsigned seed = 0; seed < 8; ++seed)
    sets.push_back(ball(seed, 10, seed % 2 == 0 ? 8e-3 : 4e-3, centre));
  return sets;
}

}  // namespace palpa::array
