// Exact scattering by a rigid sphere about the origin, the reference for the boundary elements. In double precision,
// within 1e-10 for k times radius up to 50.
#pragma once

#include <complex>
#include <vector>

#include "base/math.hpp"

namespace palpa::acoustics {

/// Total pressure of one wave on the sphere's surface.
class SphereSeries {
 public:
  /// The plane wave e^{ik d.x}; `direction` is a unit vector. h_n = j_n + i y_n:
  ///
  ///   p = i / (ka)^2 sum over n of (2n + 1) i^n P_n(cos) / h_n'(ka)
  static SphereSeries plane_wave(double wave_number, double radius, const Vec3& direction);

  /// The point source e^{ik|x - source|} / |x - source|, outside the sphere:
  ///
  ///   p = -1 / (k a^2) sum over n of (2n + 1) P_n(cos) h_n(kR) / h_n'(ka)
  static SphereSeries point_source(double wave_number, double radius, const Vec3& source);

  /// At the surface point in the direction of `place`.
  std::complex<double> at(const Vec3& place) const;

 private:
  Vec3 axis_{0};
  std::vector<std::complex<double>> factors_;  // of the Legendre polynomials
};

/// Y_p in the plane wave's force on the sphere, pi a^2 p^2 / (2 rho c^2) Y_p along the wave (Hasegawa):
///
///   Y_p = -4 / (ka)^2 sum over n of (n + 1) (a_n + a_{n+1} + 2 (a_n a_{n+1} + b_n b_{n+1})),
///   a_n + i b_n = -j_n' / h_n'
double sphere_force_function(double ka);

}  // namespace palpa::acoustics
