// Functions of direction, as values on a grid and as spherical harmonics.
//
// The grid has Gauss' rule between the poles and equal steps around, so that sums over it are exact integrals of
// products of two functions up to its order. The harmonics are orthonormal over the sphere:
//
//   f(s) = sum over l, m of c_lm Y_lm(s),   c_lm = integral of f conj(Y_lm)
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"

namespace palpa::acoustics {

class SphereGrid {
 public:
  /// Harmonics up to `order`, which is at least 0. The grid has `rings` rings, at least order + 1, each with 2 *
  /// `rings` directions. With more rings, the parts of a function above the order change its coefficients less.
  SphereGrid(std::size_t order, std::size_t rings);

  std::size_t order() const { return order_; }
  /// Unit vectors and their solid angles, ring by ring; 4 pi together.
  std::span<const Vec3> directions() const { return directions_; }
  std::span<const double> weights() const { return weights_; }

  /// From values on the grid to coefficients, entry [l * l + l + m], and back.
  std::vector<std::complex<double>> coefficients(std::span<const std::complex<double>> values) const;
  std::vector<std::complex<double>> values(std::span<const std::complex<double>> coefficients) const;

 private:
  double legendre(std::size_t ring, std::size_t l, std::size_t m) const {
    return legendre_[ring * (order_ + 1) * (order_ + 2) / 2 + l * (l + 1) / 2 + m];
  }

  std::size_t order_, rings_, around_;
  std::vector<Vec3> directions_;
  std::vector<double> weights_, ring_weights_, legendre_;
  std::vector<std::complex<double>> turns_;  // e^{2 pi i j / around}
};

}  // namespace palpa::acoustics
