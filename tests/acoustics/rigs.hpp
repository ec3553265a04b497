// What tests of sound share: arrays, air, places, and how far numbers are off.
#pragma once

#include <cmath>
#include <complex>
#include <glm/geometric.hpp>
#include <memory>
#include <numbers>

#include "acoustics/air.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "array/layouts/layout.hpp"
#include "geometry/mesh/icosphere.hpp"

namespace palpa::acoustics {

/// Adds up how far numbers are off.
class Deviation {
 public:
  void add(std::complex<double> found, std::complex<double> right, double weight = 1) {
    wrong_ += weight * std::norm(found - right);
    all_ += weight * std::norm(right);
  }
  /// In the relative L2.
  double relative() const { return std::sqrt(wrong_ / all_); }

 private:
  double wrong_ = 0, all_ = 0;
};

template <typename Found, typename Right>
double relative_error(const Found& found, const Right& right) {
  Deviation off;
  for (std::size_t i = 0; i < right.size(); ++i)
    off.add(found[i], right[i]);
  return off.relative();
}

/// Directions all around.
inline Vec3 direction(int i) {
  return glm::normalize(Vec3(std::sin(1.7 * i), std::cos(2.9 * i), std::sin(0.6 * i + 1)));
}

/// In the world, at the height at which a finger touches an object's top.
inline array::Layout posed(const char* name) {
  const array::Layout layout = array::load_layout(name);
  return array::transformed(layout, layout.default_T_world_layout);
}

/// Transducers all around the origin, facing it, from `nearest_m` on; every seventh has the same distance.
inline array::Layout shell(int count, double nearest_m = 0.15, double step_m = 0) {
  array::Layout layout;
  for (int i = 0; i < count; ++i) {
    const double z = (i + 0.5) * 2 / count - 1, angle = 2.4 * i, r = std::sqrt(1 - z * z);
    const Vec3 out(r * std::cos(angle), r * std::sin(angle), z);
    layout.transducers.push_back({(nearest_m + step_m * (i % 7)) * out, -out});
  }
  return layout;
}

/// Lossless air in which the tone has this wave number.
inline Air air_with(double wave_number) {
  Air air = without_absorption(air_of({}));
  air.medium.frequency = wave_number * air.medium.sound_speed / (2 * std::numbers::pi);
  return air;
}

inline const Air& still_air() {
  static const Air air = without_absorption(air_of({}));
  return air;
}

/// A ball as a finger, about the origin: one operator for all tests.
inline constexpr double ball_radius = 8e-3;
inline const std::shared_ptr<const RigidBody>& shared_ball() {
  static const auto body =
      std::make_shared<const RigidBody>(geometry::icosphere(ball_radius, 9), still_air().wave_number());
  return body;
}
inline const RigidBody& ball() {
  return *shared_ball();
}

}  // namespace palpa::acoustics
