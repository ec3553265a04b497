// Sets of foci as the solvers' figures are stated for.
#pragma once

#include <random>
#include <vector>

#include "array/drive.hpp"

namespace palpa::array {

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

}  // namespace palpa::array
