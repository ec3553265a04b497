// The sets of foci for which the loudness of the weakest focus is compared with its optimum (loud_optima.txt): rings,
// balls, lines and two fingers, in any direction.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "focus_sets.hpp"

namespace palpa::array {

/// Random numbers that are the same with every standard library.
class SetRandom {
 public:
  explicit SetRandom(std::uint32_t seed) : random_(seed) {}
  double between(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }
  Vec3 in_ball() {
    for (;;) {
      const double x = between(-1, 1), y = between(-1, 1), z = between(-1, 1);
      if (const Vec3 at(x, y, z); glm::dot(at, at) <= 1) return at;
    }
  }
  Vec3 direction() {
    for (;;) {
      if (const Vec3 at = in_ball(); glm::dot(at, at) > 0.01) return glm::normalize(at);
    }
  }

  /// A vector in any direction. Its direction is drawn first: compilers differ in which factor of a product they
  /// compute first, and the sets must be those of the optima with each of them.
  Vec3 vector(double shortest, double longest) {
    const Vec3 along = direction();
    return between(shortest, longest) * along;
  }

 private:
  std::mt19937 random_;
};

/// Appends `count` foci evenly on a circle in any plane.
inline void add_ring(SetRandom& random, std::size_t count, double radius, const Vec3& centre,
                     std::vector<SlotFocus>& foci) {
  const Vec3 u = random.direction();
  Vec3 v = glm::cross(u, random.direction());
  while (glm::length(v) < 0.1)
    v = glm::cross(u, random.direction());
  v = glm::normalize(v);
  const std::vector<SlotFocus> added = ring(count, radius, centre, u, v);
  foci.insert(foci.end(), added.begin(), added.end());
}

/// Set `number` of `fewest` to `most` foci about the middle of a layout's space. The numbers take turns: a ring of 1.5
/// to 15 mm radius, a ball of the same radius, a line of 3 to 30 mm, two rings of 1.5 to 8 mm some 20 to 40 mm apart.
inline std::vector<SlotFocus> loud_set(std::uint32_t number, std::size_t fewest, std::size_t most, const Vec3& middle) {
  SetRandom random(static_cast<std::uint32_t>(number * 97 + fewest));
  const auto count =
      static_cast<std::size_t>(random.between(static_cast<double>(fewest), static_cast<double>(most) + 0.9999));
  const Vec3 centre = middle + 0.02 * random.in_ball();
  std::vector<SlotFocus> foci;
  switch (number % 4) {
    case 0:
      add_ring(random, count, random.between(1.5e-3, 15e-3), centre, foci);
      break;
    case 1: {
      const double radius = random.between(1.5e-3, 15e-3);
      while (foci.size() < count)
        foci.push_back({centre + radius * random.in_ball()});
      break;
    }
    case 2: {
      const Vec3 way = random.vector(3e-3, 30e-3);
      for (std::size_t i = 0; i < count; ++i)
        foci.push_back({centre + (static_cast<double>(i) / static_cast<double>(count - 1) - 0.5) * way});
      break;
    }
    default: {
      const Vec3 way = random.vector(10e-3, 20e-3);
      add_ring(random, count / 2, random.between(1.5e-3, 8e-3), centre - way, foci);
      add_ring(random, count - count / 2, random.between(1.5e-3, 8e-3), centre + way, foci);
      break;
    }
  }
  return foci;
}

/// The middle of the space over or in a built-in layout.
inline Vec3 middle_of(const Layout& layout) {
  return layout.name == "paper" ? Vec3(0) : Vec3(0, 0, 0.15);
}

}  // namespace palpa::array
